// SPDX-License-Identifier: GPL-3.0-or-later
// `--from` and its options set configuration keys, before `--set`: there is one way to express a
// configuration, and one hash of it. Omitted values come from the raster's header and appear in the
// resolved configuration as numbers.
#include "store/config/import_config.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/error.h"
#include "base/text/characters.h"
#include "base/text/netcdf_name.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"
#include "chain/terrain/mesh/mesh_name.h"
#include "store/config/plain_number.h"
#include "store/config/schema.h"
#include "store/config/stage_sections.h"
#include "store/config/terrain_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// 60 becomes an integer and 60.0 a float, as in a JSON file: the hash depends on it.
Json number_of(const std::string& text, const char* option) {
  Json value = Json::parse(text, nullptr, false);
  if (value.is_number()) return value;
  const auto number = exact_number<double>(trimmed(text));
  if (!number || !std::isfinite(*number))
    throw UsageError(std::string(option) + ": '" + abbreviated(text) + "' is not a number");
  return *number;
}

Json option_pair(const std::string& text, const char* option) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos)
    throw UsageError(std::string(option) + ": '" + abbreviated(text) +
                     "' is not two numbers separated by a comma");
  return {number_of(text.substr(0, comma), option), number_of(text.substr(comma + 1), option)};
}

/// "none", a number, or a list of numbers.
Json nodata_of(const std::string& text) {
  if (text == "none") return text;
  Json numbers = Json::array();
  for (const std::string& part : split_at(text, ',')) numbers.push_back(number_of(part, "--nodata"));
  return numbers.size() == 1 ? numbers[0] : numbers;
}

Json imported_base(const ImportOptions& options) {
  Json base = {{"type", "dem"}, {"path", options.from}};
  if (!options.center.empty()) base["center"] = option_pair(options.center, "--center");
  if (!options.center_pixel.empty())
    base["center_pixel"] = option_pair(options.center_pixel, "--center-pixel");
  if (!options.band.empty()) base["band"] = number_of(options.band, "--band");
  if (!options.interpolation.empty()) base["interpolation"] = options.interpolation;
  if (!options.datum.empty()) base["datum"] = options.datum;
  if (!options.vertical_scale.empty())
    base["vertical_scale"] = number_of(options.vertical_scale, "--vertical-scale");
  if (!options.horizontal_scale.empty())
    base["horizontal_scale_m"] = number_of(options.horizontal_scale, "--horizontal-scale");
  if (!options.crs.empty()) base["crs"] = options.crs;
  if (!options.nodata.empty()) base["nodata"] = nodata_of(options.nodata);
  return base;
}

std::optional<double> optional_number(const Json& grid, const char* key) {
  if (!grid.is_object() || !grid.contains(key)) return std::nullopt;
  return grid.at(key).get<double>();
}

void set_in_grid(JsonSource& source, const char* key, const std::string& text, const char* option) {
  if (text.empty()) return;
  Json& grid = source.value["grid"];
  if (!grid.is_null() && !grid.is_object())
    throw UsageError(source.name + ": /grid: is not an object, so " + option + " cannot be set");
  grid[key] = number_of(text, option);
}

bool gives_only_from(const ImportOptions& options) {
  ImportOptions only_from;
  only_from.from = options.from;
  return options == only_from;
}

/// Whether only options are given that a mesh has.
bool fits_a_mesh(ImportOptions options) {
  options.up.clear();
  return gives_only_from(options);
}

void set_up(JsonSource& source, const ImportOptions& options) {
  if (options.up.empty()) return;
  if (!source.value.is_object() || !source.value.contains("mesh") || !source.value["mesh"].is_object())
    throw UsageError("--up " + options.up + ": is for a mesh; " +
                     (options.from.empty() ? source.name + " has none" : options.from + " is not one"));
  source.value["mesh"]["up"] = options.up;
}

/// Merges what the configuration says of the base, or of the mesh, over what the import makes of it.
void merge_import(JsonSource& source, const char* part, Json made) {
  const std::string where = source.name + ": /" + part;
  const Json given = source.value.value(part, Json::object());
  if (!given.is_object())
    throw UsageError(where + ": the configuration has a " + part + " and the import makes one; remove one");
  const Json type = made.value("type", Json());
  if (given.value("type", type) != type)
    throw UsageError(where + "/type: " + abbreviated(given["type"].dump()) +
                     ": the import makes a base of type \"dem\"; remove this base or the import");
  for (const auto& [key, value] : given.items())
    if (key != "type" && made.contains(key))
      throw UsageError(where + "/" + key + ": the import gives it too; remove one");
  made.update(given);
  source.value[part] = std::move(made);
}

void apply_mesh_import(JsonSource& source, const ImportOptions& options) {
  if (!fits_a_mesh(options))
    throw UsageError("--from " + options.from +
                     ": options of rasters and grids do not apply to a mesh; set mesh.scale_m, "
                     "mesh.translate_m and mesh.rotate_rpy_deg instead");
  merge_import(source, "mesh", {{"path", options.from}});
  set_up(source, options);
}

}  // namespace

void apply_import(JsonSource& source, const ImportOptions& options) {
  if (is_mesh_name(options.from)) return apply_mesh_import(source, options);
  set_up(source, options);
  if (!options.from.empty()) merge_import(source, "base", imported_base(options));
  set_in_grid(source, "half_width_m", options.half_width, "--half-width");
  set_in_grid(source, "resolution_m", options.resolution, "--resolution");
}

void require_plain_export(const ImportOptions& options, bool configured) {
  if (configured || !gives_only_from(options))
    throw UsageError("--from " + options.from +
                     ": a landfall file is exported as it is, without configuration; to cut or interpolate a "
                     "terrain, name its layer as a raster: " +
                     netcdf_name(options.from, "z").value_or(kNoNetcdfName));
}

void complete_import(JsonSource& source, const ImportOptions& options, const SiteFitter& fit) {
  if (is_mesh_name(options.from)) return;
  const Json& base = source.value.at("base");
  if (!base.is_object() || base.value("path", Json()) != options.from)
    throw UsageError("--set base: --from " + options.from +
                     " defines the base; set its keys instead (base.datum)");
  // Finds errors anywhere in the configuration before the raster is opened; the numbers that are not set yet
  // have defaults here.
  const Json resolved = resolve_config(source, embedded_schema("terrain"));
  const Json grid = source.value.value("grid", Json::object());
  const SiteRequest request{optional_number(grid, "half_width_m"), optional_number(grid, "resolution_m")};
  if (request.half_width_m && request.resolution_m) return;
  const SiteSize size = fit(dem_base(resolved.at("base")), request);
  if (!request.half_width_m) source.value["grid"]["half_width_m"] = plain_number(size.half_width_m);
  if (!request.resolution_m) source.value["grid"]["resolution_m"] = plain_number(size.resolution_m);
}

Json import_section(const std::string& from, const std::string& center) {
  Json section = {{"from", from}};
  if (!center.empty()) section["center"] = option_pair(center, "--center");
  return section;
}

void import_terrain(JsonSource& config, const SiteFitter& fit) {
  if (!config.value.is_object() || !config.value.contains("terrain")) return;
  JsonSource terrain = stage_source("terrain", config.value["terrain"], config.name);
  if (!terrain.value.is_object()) return;
  const Json center = terrain.value.value("center", Json());
  if (!terrain.value.contains("from") && !center.is_null())
    throw UsageError(terrain.name + "/center: is the site of a raster; give terrain.from too");
  const bool is_pair =
      center.is_array() && center.size() == 2 && center[0].is_number() && center[1].is_number();
  if (!is_import(config.value) || !(is_pair || center.is_null())) return;
  ImportOptions options;
  options.from = terrain.value["from"].get<std::string>();
  if (is_pair) options.center = center[0].dump() + "," + center[1].dump();
  terrain.value.erase("from");
  terrain.value.erase("center");
  const bool is_mesh = is_mesh_name(options.from);
  if (is_mesh && is_pair)
    throw UsageError(terrain.name +
                     "/center: is the site of a raster; set terrain.mesh.translate_m for a mesh");
  if (!is_mesh && terrain.value.contains("mesh"))
    throw UsageError(terrain.name + ": /mesh: the import of " + options.from + " makes a base; remove one");
  apply_import(terrain, options);
  complete_import(terrain, options, fit);
  config.value["terrain"] = std::move(terrain.value);
}

}  // namespace landfall
