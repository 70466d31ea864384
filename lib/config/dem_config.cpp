// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/dem_config.h"

#include <map>

#include "config/config_path.h"
#include "config/own_requirement_config.h"
#include "evaluation/metrics.h"

namespace landfall {

namespace {

Method method_of(const std::string& name) {
  using enum Method;
  static const std::map<std::string, Method> kMethods = {{"bilinear_nearest", bilinear_nearest},
                                                         {"bilinear4", bilinear4},
                                                         {"mean", mean},
                                                         {"min", min},
                                                         {"max", max},
                                                         {"median", median}};
  return kMethods.at(name);
}

}  // namespace

RegridConfig regrid_config(const nlohmann::json& resolved, const std::string& name) {
  RegridConfig config;
  config.grid = GridSpec::centered(resolved.at("half_width_m").get<double>(),
                                   resolved.at("resolution_m").get<double>(), (name + ": /").c_str());
  config.truth_at = resolved.at("truth_at") == "centroid" ? TruthAt::centroid : TruthAt::bin_center;
  config.method = method_of(resolved.at("method").get<std::string>());
  return config;
}

namespace {

void require_keys(const nlohmann::json& region, const std::string& name) {
  const std::string shape = region.at("shape");
  const auto check_key = [&](const char* key, const char* owner, bool required) {
    if (region.contains(key) && shape != owner)
      throw UsageError(name + ": /region/" + key + ": is allowed only with the shape " + owner +
                       ", not with " + shape + "; set /region/shape to \"" + owner + "\"");
    if (required && !region.contains(key) && shape == owner)
      throw UsageError(name + ": /region: the shape " + owner + " needs the key \"" + key + "\"");
  };
  check_key("half_width_m", "square", true);
  check_key("path", "mask", true);
  check_key("layer", "mask", false);
}

RegionShape region_shape(const std::string& name) {
  return name == "circle" ? RegionShape::circle : name == "square" ? RegionShape::square : RegionShape::mask;
}

}  // namespace

std::optional<RegionMaskSource> region_mask_source(const nlohmann::json& resolved) {
  const nlohmann::json& region = resolved.at("region");
  if (region.at("shape") != "mask") return std::nullopt;
  return RegionMaskSource{region.at("path"), region.value("layer", "mask")};
}

EvaluationParameters evaluation_config(const nlohmann::json& resolved, const std::string& name) {
  EvaluationParameters parameters;
  const nlohmann::json& region = resolved.at("region");
  require_keys(region, name);
  parameters.region_shape = region_shape(region.at("shape"));
  parameters.region_half_width_m = region.value("half_width_m", parameters.region_half_width_m);
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
