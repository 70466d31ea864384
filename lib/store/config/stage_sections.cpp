// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D412, D460
#include "store/config/stage_sections.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "base/core/error.h"
#include "base/dictionary/tables/stages.h"
#include "base/text/shown_text.h"
#include "chain/terrain/mesh/mesh_name.h"
#include "store/config/plain_number.h"
#include "store/config/presets.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

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

/// The configuration that a preset or an object stands for.
Json part_of(const Json& part, const std::string& stage, const std::string& where) {
  if (!part.is_string()) return part;
  const auto name = part.get<std::string>();
  if (!name.starts_with("preset:"))
    throw UsageError(where + ": '" + abbreviated(name) + "' is neither an object nor preset:NAME");
  try {
    return read_config({name}, stage).value;
  } catch (const UsageError& error) {
    throw UsageError(where + ": " + error.what());
  }
}

void expand(Json& section, const std::string& stage, const std::string& where) {
  if (section.is_string()) section = part_of(section, stage, where);
  if (section.is_array()) {
    Json merged = Json::object();
    for (std::size_t i = 0; i < section.size(); ++i) {
      const std::string element = where + "/" + std::to_string(i);
      const Json part = part_of(section[i], stage, element);
      if (!part.is_object()) throw UsageError(element + ": is neither an object nor preset:NAME");
      merge_keeping_nulls(merged, part);
    }
    section = std::move(merged);
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

bool has_stage_sections(const std::string& schema) { return schema == "chain" || schema == "draws"; }

void expand_stage_sections(JsonSource& source) {
  if (!source.value.is_object()) return;
  for (const char* const schema : {"chain", "draws"})
    for (const std::string& stage : stage_sections(schema))
      if (source.value.contains(stage)) expand(source.value[stage], stage, source.name + ": /" + stage);
}

bool is_import(const Json& config) {
  if (!config.is_object() || !config.contains("terrain")) return false;
  const Json& terrain = config["terrain"];
  return terrain.is_object() && terrain.contains("from") && terrain["from"].is_string() &&
         terrain["from"] != "";
}

void place_import(Json& config, const std::filesystem::path& folder) {
  if (!is_import(config)) return;
  Json& from = config["terrain"]["from"];
  const auto name = from.get<std::string>();
  const std::filesystem::path placed = folder / name;
  std::error_code unreachable;
  const bool is_gdal_name =
      name.find(':') != std::string::npos && !std::filesystem::exists(placed, unreachable);
  if (!is_gdal_name) from = placed.string();
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
