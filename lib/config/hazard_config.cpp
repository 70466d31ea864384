// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/hazard_config.h"

#include <string>

#include "config/own_requirement_config.h"

namespace landfall {
namespace {

Lander lander_of(const nlohmann::json& json) {
  return {.legs = json.at("legs"),
          .leg_radius_m = json.at("leg_radius_m"),
          .pad_diameter_m = json.at("pad_diameter_m"),
          .pad_height = json.at("pad_height") == "max" ? PadHeight::max : PadHeight::mean,
          .body_radius_m = json.at("body_radius_m")};
}

HazardMethod hazard_method(const std::string& name) {
  if (name == "plane") return HazardMethod::plane;
  if (name == "range_difference") return HazardMethod::range_difference;
  if (name == "lmeds") return HazardMethod::lmeds;
  return HazardMethod::contact;
}

SiteParameters sites_of(const nlohmann::json& json) {
  return {.count = json.at("count"),
          .separation_m = json.at("separation_m"),
          .divert_radius_m = json.at("divert_radius_m"),
          .divert_weight = json.at("divert_weight"),
          .min_p = json.at("min_p")};
}

}  // namespace

HazardParameters hazard_config(const nlohmann::json& resolved, const std::string& name) {
  HazardParameters parameters;
  parameters.lander = lander_of(resolved.at("lander"));
  parameters.method = hazard_method(resolved.at("method"));
  parameters.region_radius_m = resolved.at("region_radius_m");
  parameters.limits = {resolved.at("limits").at("slope_deg"), resolved.at("limits").at("roughness_m")};
  parameters.hole_fill_bins = resolved.at("hole_fill_bins");
  if (!resolved.at("z_sigma_m").is_null()) parameters.z_sigma_m = resolved.at("z_sigma_m").get<double>();
  parameters.touchdown_sigma_m = resolved.at("touchdown_sigma_m");
  parameters.sites = sites_of(resolved.at("sites"));
  parameters.seed = resolved.at("seed");
  parameters.own_requirements =
      own_requirements(resolved, name + ": ", {"score.json", result_fields(HazardScore{})});
  return parameters;
}

}  // namespace landfall
