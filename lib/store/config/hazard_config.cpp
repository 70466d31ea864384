// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/hazard_config.h"

#include <string>

#include "chain/hazards/map_judge.h"
#include "store/config/config_path.h"
#include "store/config/dem_config.h"
#include "store/config/json_values.h"
#include "store/config/own_requirement_config.h"
#include "store/config/region_config.h"

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

DivertStart divert_start(const nlohmann::json& json) {
  return {.height_m = json.at("height_m"),
          .descent_mps = json.at("descent_mps"),
          .velocity_mps = horizontal(json.at("velocity_mps")),
          .position_m = horizontal(json.at("position_m")),
          .tilt_rad = radians(json, "tilt_deg"),
          .thrust_accel_mps2 = json.at("thrust_accel_mps2"),
          .gravity_mps2 = json.at("gravity_mps2")};
}

ReachableArea reach_of(const nlohmann::json& json, const std::string& name) {
  if (json.is_array()) return ReachableArea::polygon(ring_of(json));
  return at_path(name + ": /sites/reach/", [&] { return ReachableArea::divert(divert_start(json)); });
}

SiteParameters sites_of(const nlohmann::json& json, const std::string& name) {
  SiteParameters sites{.count = json.at("count"),
                       .separation_m = json.at("separation_m"),
                       .divert_radius_m = json.at("divert_radius_m"),
                       .divert_weight = json.at("divert_weight"),
                       .min_p = json.at("min_p")};
  if (json.contains("reach")) sites.reach = reach_of(json.at("reach"), name);
  return sites;
}

}  // namespace

HazardParameters hazard_config(const nlohmann::json& resolved, const std::string& name) {
  HazardParameters parameters;
  parameters.lander = lander_of(resolved.at("lander"));
  parameters.method = hazard_method(resolved.at("method"));
  const RegionConfig region = region_config(resolved, name);
  parameters.region_shape = region.shape;
  parameters.region_center_m = region.center_m;
  parameters.region_radius_m = resolved.at("region_radius_m");
  parameters.limits = {resolved.at("limits").at("slope_deg"), resolved.at("limits").at("roughness_m")};
  parameters.hole_fill_bins = resolved.at("hole_fill_bins");
  if (!resolved.at("z_sigma_m").is_null()) parameters.z_sigma_m = resolved.at("z_sigma_m").get<double>();
  parameters.touchdown_sigma_m = resolved.at("touchdown_sigma_m");
  parameters.sites = sites_of(resolved.at("sites"), name);
  parameters.seed = resolved.at("seed");
  parameters.own_requirements =
      own_requirements(resolved, name + ": ", {"score.json", result_fields(HazardScore{})});
  return parameters;
}

void check_hazard_map(const nlohmann::json& hazard, const nlohmann::json& regrid, const std::string& name) {
  const HazardParameters parameters = hazard_config(hazard, name + ": /hazard");
  const GridSpec grid = regrid_config(regrid, name + ": /regrid").grid;
  try {
    static_cast<void>(MapJudge(parameters, grid));
  } catch (const UsageError& error) {
    throw UsageError(name + ": /hazard/" + error.what() +
                     " (regrid.resolution_m or area.resolution_m; the map has regrid.half_width_m or "
                     "area.half_width_m); \"hazard\": null maps no hazards");
  }
}

}  // namespace landfall
