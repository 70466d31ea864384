// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/dem_config.h"

#include <map>

#include "base/raster/grid_spec.h"
#include "chain/evaluation/metrics.h"
#include "store/config/config_path.h"
#include "store/config/json_values.h"
#include "store/config/own_requirement_config.h"
#include "store/config/region_config.h"

namespace landfall {

namespace {

Method method_named(const std::string& name) {
  using enum Method;
  static const std::map<std::string, Method> kMethods = {{"bilinear_nearest", bilinear_nearest},
                                                         {"bilinear4", bilinear4},
                                                         {"mean", mean},
                                                         {"min", min},
                                                         {"max", max},
                                                         {"median", median}};
  return kMethods.at(name);
}

Horizontal map_center(const nlohmann::json& resolved) {
  return resolved.contains("center_m") ? horizontal(resolved.at("center_m")) : Horizontal{};
}

}  // namespace

RegridConfig regrid_config(const nlohmann::json& resolved, const std::string& name) {
  RegridConfig config;
  config.grid = grid_over({pair_of(resolved.at("half_width_m")), map_center(resolved)},
                          resolved.at("resolution_m").get<double>(), (name + ": /").c_str());
  config.truth_at = resolved.at("truth_at") == "centroid" ? TruthAt::centroid : TruthAt::bin_center;
  config.method = method_named(resolved.at("method").get<std::string>());
  return config;
}

EvaluationParameters evaluation_config(const nlohmann::json& resolved, const std::string& name) {
  EvaluationParameters parameters;
  const RegionConfig region = region_config(resolved, name);
  parameters.region_shape = region.shape;
  parameters.region_center_m = region.center_m;
  if (region.half_width_m) parameters.region_half_width_m = *region.half_width_m;
  parameters.region_radius_m = resolved.at("region_radius_m").get<double>();
  parameters.footprint_m = resolved.at("footprint_m").get<double>();
  parameters.footprint_shape =
      resolved.at("footprint_shape") == "disc" ? FootprintShape::disc : FootprintShape::square;
  parameters.quantile = resolved.at("quantile").get<double>();
  const nlohmann::json& limits = resolved.at("limits");
  FieldWalk walk{[&](const std::string& key, auto& limit) { limits.at(key).get_to(limit); }};
  EvaluationLimits::fields(walk, parameters.limits);
  parameters.own_requirements = own_requirements(resolved, name + ": ", {"metrics.json", metrics_fields()});
  at_path(name + ": /", [&] { check(parameters); });
  return parameters;
}

}  // namespace landfall
