// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/dem_config.h"

#include "base/error.h"

namespace landfall {

RegridConfig regrid_config(const nlohmann::json& resolved, const std::string& name) {
  RegridConfig config;
  config.grid = GridSpec::centered(resolved.at("half_width_m").get<double>(),
                                   resolved.at("resolution_m").get<double>(), (name + ": /").c_str());
  config.truth_at = resolved.at("truth_at") == "centroid" ? TruthAt::centroid : TruthAt::bin_center;
  return config;
}

EvaluationParameters evaluation_config(const nlohmann::json& resolved, const std::string& name) {
  EvaluationParameters parameters;
  parameters.region_radius_m = resolved.at("region_radius_m").get<double>();
  parameters.footprint_m = resolved.at("footprint_m").get<double>();
  parameters.footprint_shape =
      resolved.at("footprint_shape") == "disc" ? FootprintShape::disc : FootprintShape::square;
  parameters.quantile = resolved.at("quantile").get<double>();
  const nlohmann::json& limits = resolved.at("limits");
  parameters.limits.invalid_frac = limits.at("invalid_frac").get<double>();
  parameters.limits.hole_bins = limits.at("hole_bins").get<std::int64_t>();
  parameters.limits.distance_bins = limits.at("distance_bins").get<double>();
  parameters.limits.relative_elevation_m = limits.at("relative_elevation_m").get<double>();
  parameters.limits.relative_horizontal_m = limits.at("relative_horizontal_m").get<double>();
  parameters.limits.absolute_horizontal_m = limits.at("absolute_horizontal_m").get<double>();
  parameters.limits.absolute_horizontal_frac = limits.at("absolute_horizontal_frac").get<double>();
  try {
    check(parameters);
  } catch (const UsageError& error) {
    throw UsageError(name + ": /" + error.what());
  }
  return parameters;
}

}  // namespace landfall
