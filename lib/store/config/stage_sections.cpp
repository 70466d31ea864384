// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D412, D460
#include "store/config/stage_sections.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/core/error.h"
#include "base/dictionary/tables/stages.h"
#include "base/text/file_path.h"
#include "base/text/shown_text.h"
#include "chain/terrain/mesh/mesh_name.h"
#include "store/config/plain_number.h"
#include "store/config/presets.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

namespace fs = std::filesystem;

/// The place of a value: its pointer in a file, for messages, and the folder of the file.
struct Place {
  std::string where;
  fs::path folder;
};

constexpr double kTerrainMargin = 10;  // m
constexpr double kFineSpacing = 0.1;   // m; no terrain needs finer nodes than this because of a footprint
constexpr double kNodesPerFootprint = 17;

/// Merges as RFC 7396 does, but keeps a null, which removes the key when the result is merged later.
void merge_keeping_nulls(Json& base, const Json& changes) {
  if (!changes.is_object() || !base.is_object()) {
    base = changes;
    return;
  }
  for (const auto& [key, value] : changes.items())
    if (base.contains(key))
      merge_keeping_nulls(base[key], value);
    else
      base[key] = value;
}

/// Joins "from" of a section of the terrain to the folder of the file that names it. Absolute paths and names
/// that are no file there but one of GDAL's (NETCDF:"f.h5":z) stay.
void place_import(Json& section, const fs::path& folder) {
  if (!section.is_object() || !section.contains("from") || !section["from"].is_string()) return;
  const auto name = section["from"].get<std::string>();
  const fs::path placed = folder / name;
  const bool is_gdal_name = name.find(':') != std::string::npos && !fs::exists(status_of(placed));
  if (!name.empty() && !is_gdal_name) section["from"] = placed.string();
}

/// The message for a text that names neither a preset nor a file.
std::string unknown_file(const std::string& name, const std::string& stage) {
  const std::string preset = "preset:" + name;
  const bool is_preset = std::ranges::any_of(presets(stage), [&](const Preset& p) { return p.name == name; });
  return "'" + abbreviated(name) + "': no such file; " +
         (is_preset ? "did you mean \"" + preset + "\"?"
                    : "expected an object, a file, \"preset:NAME\" or a list of these");
}

/// The configuration that an object, a preset or a file, seen from `folder`, stands for.
Json part_of(const Json& part, const std::string& stage, const Place& place) {
  if (!part.is_string()) {
    Json own = part;
    if (stage == "terrain") place_import(own, place.folder);
    return own;
  }
  auto name = part.get<std::string>();
  const bool is_file = !name.starts_with("preset:");
  if (is_file && !fs::exists(status_of(place.folder / name)))
    throw UsageError(place.where + ": " + unknown_file(name, stage));
  if (is_file) name = (place.folder / name).string();
  try {
    Json read = read_config({name}, stage).value;
    if (stage == "terrain" && is_file) place_import(read, fs::path(name).parent_path());
    return read;
  } catch (const UsageError& error) {
    throw UsageError(place.where + ": " + error.what());
  }
}

void expand(Json& section, const std::string& stage, const Place& place) {
  if (section.is_array()) {
    Json merged = Json::object();
    for (std::size_t i = 0; i < section.size(); ++i) {
      const std::string element = place.where + "/" + std::to_string(i);
      const Json part = part_of(section[i], stage, {element, place.folder});
      if (!part.is_object()) throw UsageError(element + ": is not an object, a file or \"preset:NAME\"");
      merge_keeping_nulls(merged, part);
    }
    section = std::move(merged);
  } else {
    section = part_of(section, stage, place);
  }
  if (!section.is_object()) return;
  section.erase("$schema");
  section.erase("$comment");
}

std::optional<double> given_number(const Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number()) return std::nullopt;
  return object[key].get<double>();
}

/// Sets a key that is not given.
void fill(Json& object, const char* key, const std::optional<double>& value) {
  if (value && object.is_object() && !object.contains(key)) object[key] = plain_number(*value);
}

bool is_mesh_import(const Json& terrain) {
  const Json from = terrain.value("from", Json());
  return from.is_string() && is_mesh_name(from.get<std::string>());
}

/// The number nearest to a multiple in decimal: 40.1, not 401 * 0.1 = 40.1000000000000001.
double rounded(double length_m) { return std::round(length_m * 1e9) / 1e9; }

/// The node spacing of a terrain under bins of this width: coarse bins do not make the ground that a
/// footprint is judged by coarse (D460).
std::optional<double> terrain_spacing(const std::optional<double>& resolution_m, const Json& eval) {
  if (!resolution_m) return std::nullopt;
  const Json footprint_m =
      default_at(eval.is_object() ? eval : Json::object(), embedded_schema("eval"), "/footprint_m");
  if (!footprint_m.is_number()) return resolution_m;  // of a section that is refused later
  return std::min(*resolution_m,
                  rounded(std::max(kFineSpacing, footprint_m.get<double>() / kNodesPerFootprint)));
}

void fill_terrain(Json& terrain, const std::optional<double>& half_width_m,
                  const std::optional<double>& resolution_m) {
  if (!terrain.is_object() || terrain.contains("mesh") || is_mesh_import(terrain)) return;
  if (!terrain.contains("grid")) terrain["grid"] = Json::object();
  Json& grid = terrain["grid"];
  fill(grid, "resolution_m", resolution_m);
  const Json defaults = default_at(Json::object(), embedded_schema("terrain"), "/grid");
  const double spacing_m =
      given_number(grid, "resolution_m").value_or(defaults.at("resolution_m").get<double>());
  if (half_width_m && spacing_m > 0) fill(grid, "half_width_m", terrain_half_width(*half_width_m, spacing_m));
}

/// The radius only for a region that has one.
void fill_region(Json& section, const Json& area, const std::optional<double>& radius_m) {
  if (!section.is_object()) return;
  if (area.contains("region") && !section.contains("region")) section["region"] = area["region"];
  const Json region = section.value("region", Json::object());
  if (!region.is_object() || region.value("shape", Json("circle")) == "circle")
    fill(section, "region_radius_m", radius_m);
}

}  // namespace

const std::vector<std::string>& stage_sections(const std::string& schema) {
  static const auto sections_of = [](std::string_view whole) {
    std::vector<std::string> names;
    for (const dictionary::Stage& stage : dictionary::kStages)
      if (std::string_view(stage.part_of).find(whole) != std::string_view::npos)
        names.emplace_back(stage.name);
    return names;
  };
  static const std::vector<std::string> chain = sections_of("chain");
  static const std::vector<std::string> draws = sections_of("draws");
  return schema == "chain" ? chain : draws;
}

JsonSource stage_source(const std::string& stage, const Json& section, const std::string& name) {
  JsonSource source{name + ": /" + stage, section};
  if (stage == "terrain") source.imported = {"center", "from"};
  return source;
}

bool has_stage_sections(const std::string& schema) { return schema == "chain" || schema == "draws"; }

void expand_stage_sections(JsonSource& source, const std::filesystem::path& folder) {
  if (!source.value.is_object()) return;
  for (const std::string& stage : stage_sections("chain"))
    if (source.value.contains(stage))
      expand(source.value[stage], stage, {source.name + ": /" + stage, folder});
}

bool is_import(const Json& config) {
  if (!config.is_object() || !config.contains("terrain")) return false;
  const Json& terrain = config["terrain"];
  return terrain.is_object() && terrain.contains("from") && terrain["from"].is_string() &&
         terrain["from"] != "";
}

double terrain_half_width(double half_width_m, double resolution_m) {
  return rounded(std::ceil((half_width_m + kTerrainMargin) / resolution_m - 1e-9) * resolution_m);
}

void fill_area(Json& config, bool makes_all) {
  if (!config.is_object() || !config.contains("area")) return;
  const Json area = config["area"];
  if (!area.is_object()) return;  // refused later
  const std::optional<double> half_width_m = given_number(area, "half_width_m");
  const std::optional<double> resolution_m = given_number(area, "resolution_m");
  std::optional<double> radius_m = given_number(area, "region_radius_m");
  if (!radius_m) radius_m = half_width_m;
  for (const std::string& stage : stage_sections(makes_all ? "chain" : "draws"))
    if (!config.contains(stage) && (makes_all || stage == "regrid" || stage == "eval"))
      config[stage] = Json::object();
  if (config.contains("terrain"))
    fill_terrain(config["terrain"], half_width_m, terrain_spacing(resolution_m, config["eval"]));
  fill(config["regrid"], "half_width_m", half_width_m);
  fill(config["regrid"], "resolution_m", resolution_m);
  fill_region(config["eval"], area, radius_m);
  if (config.contains("hazard")) fill_region(config["hazard"], area, radius_m);
}

}  // namespace landfall
