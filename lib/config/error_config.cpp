// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_values.h"
#include "config/scan_components.h"

namespace landfall {

using Json = nlohmann::json;

RangeErrors make_range_errors(const Json& noise, const ComponentContext& context) {
  return {{noise.at("range_sigma_m").get<double>(), noise.at("range_bias_m").get<double>(),
           noise.at("dead_pixel_frac").get<double>(), noise.at("dropout_frac").get<double>()},
          context.seed};
}

std::unique_ptr<const NavigationError> make_navigation_error(const Json& json, const ComponentContext&) {
  return std::make_unique<LinearNavigationError>(
      NavigationErrorParameters{{vector3(json.at("position_m"))},
                                {vector3(json.at("velocity_mps"))},
                                roll_pitch_yaw(json.at("rpy_rad"), 1),
                                roll_pitch_yaw(json.at("rpy_rate_radps"), 1)});
}

}  // namespace landfall
