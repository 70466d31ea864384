// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D117
#include "store/config/terrain_config.h"

#include <limits>

#include "base/text/parameter_check.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "store/config/config_path.h"
#include "store/config/feature_config.h"
#include "store/config/json_values.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::optional<std::array<double, 2>> optional_pair(const Json& json, const char* key) {
  if (!json.contains(key)) return std::nullopt;
  return json.at(key).get<std::array<double, 2>>();
}

Interpolation interpolation_of(const std::string& word) {
  if (word == "nearest") return Interpolation::nearest;
  return word == "bilinear" ? Interpolation::bilinear : Interpolation::bicubic;
}

/// A number in metres, "dem" or "none".
std::optional<double> longest_wavelength_m(const Json& json) {
  if (json.is_number()) return json.get<double>();
  if (json == "none") return std::numeric_limits<double>::infinity();
  return std::nullopt;
}

Base base_of(const Json& json) {
  const auto number = [&](const char* key) { return json.at(key).get<double>(); };
  if (json.at("type") == "dem") return dem_base(json);
  if (json.at("type") == "fractal")
    return FractalBase{number("hurst_exponent"), number("rms_deviation_m"), number("reference_length_m"),
                       longest_wavelength_m(json.at("longest_wavelength_m"))};
  return PlaneBase{number("elevation_m"), number("slope_x"), number("slope_y")};
}

/// The keys that say which part of which raster a site is.
DemBase site_raster(const Json& json) {
  DemBase raster;
  raster.path = json.at("path").get<std::string>();
  raster.band = json.value("band", 1);
  raster.center = optional_pair(json, "center");
  raster.center_pixel = optional_pair(json, "center_pixel");
  raster.interpolation = interpolation_of(json.at("interpolation").get<std::string>());
  if (json.contains("horizontal_scale_m"))
    raster.horizontal_scale_m = json.at("horizontal_scale_m").get<double>();
  raster.crs = json.value("crs", "");
  if (json.contains("nodata")) {
    const Json& nodata = json.at("nodata");
    raster.keeps_undeclared_fills = nodata.is_string();  // "none"
    if (nodata.is_number()) raster.nodata = {nodata.get<double>()};
    if (nodata.is_array()) raster.nodata = nodata.get<std::vector<double>>();
  }
  return raster;
}

/// A raster that is legitimately one of colours.
DemBase picture(const Json& json) {
  DemBase raster = site_raster(json);
  raster.takes_colours = true;
  return raster;
}

std::variant<double, AlbedoGradient, AlbedoPatches, AlbedoRaster> terrain_albedo(const Json& json) {
  if (json.is_number()) return json.get<double>();
  if (json.at("type") == "raster")
    return AlbedoRaster{picture(json), number(json, "scale"), number(json, "offset")};
  if (json.at("type") == "patches")
    return AlbedoPatches{number(json, "albedo"), number(json, "albedo_between"), number(json, "cover_frac"),
                         number(json, "longest_wavelength_m"), number(json, "hurst_exponent")};
  AlbedoGradient gradient{number(json, "from"), number(json, "to"), radians(json, "azimuth_deg")};
  if (json.contains("length_m")) gradient.length_m = number(json, "length_m");
  return gradient;
}

AlbedoModel albedo_of(const Json& json) {
  if (json.is_number()) return {.ground = json.get<double>()};
  AlbedoModel albedo{.ground = terrain_albedo(json.at("ground"))};
  const std::vector<std::string>& kinds = feature_kinds();
  for (std::size_t kind = 0; kind < kinds.size(); ++kind)
    if (json.at("features").contains(kinds[kind]))
      albedo.of_kind[kind] = number(json.at("features"), kinds[kind].c_str());
  return albedo;
}

TerrainModel model_of(const Json& json) {
  TerrainModel model;
  model.bases.clear();
  const Json& base = json.at("base");
  if (base.is_object()) model.bases.push_back(base_of(base));
  if (base.is_array())
    for (const Json& layer : base) model.bases.push_back(base_of(layer));
  for (const Json& feature : json.at("features")) model.features.push_back(placed_feature(feature));
  const Json& patterns = json.at("patterns");
  for (std::size_t i = 0; i < patterns.size(); ++i)
    model.patterns.push_back(feature_pattern(patterns[i], "patterns/" + std::to_string(i)));
  if (json.contains("albedo")) model.albedo = albedo_of(json.at("albedo"));
  model.seed = random_seed(json);
  return model;
}

MeshImport mesh_import(const Json& json) {
  MeshImport mesh;
  mesh.path = json.at("path").get<std::string>();
  mesh.placement.scale_m = json.at("scale_m").get<double>();
  mesh.up_is_given = json.contains("up");
  mesh.placement.y_up = json.value("up", "z") == "y";
  mesh.placement.rotate = roll_pitch_yaw(json.at("rotate_rpy_deg"), kRadiansPerDegree);
  const auto translate = json.at("translate_m").get<std::array<double, 3>>();
  mesh.placement.translate_m = Eigen::Vector3d(translate[0], translate[1], translate[2]);
  return mesh;
}

}  // namespace

DemBase dem_base(const Json& json) {
  DemBase base = site_raster(json);
  base.takes_colours = json.contains("band");
  base.datum = json.at("datum") == "center" ? Datum::center : Datum::none;
  if (json.contains("vertical_scale")) base.vertical_scale = json.at("vertical_scale").get<double>();
  return base;
}

Json resolve_terrain_config(const JsonSource& source) {
  const bool is_mesh = source.value.is_object() && source.value.contains("mesh");
  for (const char* const key : {"grid", "base", "features", "patterns", "albedo"})
    if (is_mesh && source.value.contains(key))
      throw UsageError(source.name + ": /" + key + ": is mutually exclusive with /mesh; remove one");
  Json resolved = resolve_config(source, embedded_schema("terrain"));
  if (is_mesh)
    for (const char* const key : {"grid", "base", "features", "patterns", "seed", "draw"})
      resolved.erase(key);
  return resolved;
}

TerrainConfig terrain_config(const Json& resolved, const std::string& name) {
  TerrainConfig config;
  if (resolved.contains("mesh")) {
    config.mesh = mesh_import(resolved.at("mesh"));
    return config;
  }
  const Json& grid = resolved.at("grid");
  config.grid = GridSpec::centered(grid.at("half_width_m").get<double>(),
                                   grid.at("resolution_m").get<double>(), (name + ": /grid").c_str());
  at_path(name + ": /", [&] {
    config.model = model_of(resolved);
    validate(config.model, config.grid);
    for (std::size_t i = 0; i < config.model.patterns.size(); ++i)
      require_bounded(config.model.patterns[i], pattern_site(config.grid, config.model.seed, i));
  });
  return config;
}

}  // namespace landfall
