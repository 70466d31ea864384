// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "config/json_values.h"
#include "config/scan_components.h"
#include "detector/perspective.h"

namespace landfall {

using Json = nlohmann::json;

Detector make_detector(const Json& json, const ComponentContext&) {
  PerspectiveParameters detector;
  detector.rows = json.at("rows").get<int>();
  detector.columns = json.at("columns").get<int>();
  detector.subpixels = json.at("subpixels").get<int>();
  detector.roll_rad = radians(json, "roll_deg");
  if (json.contains("ifov_rad") && json.contains("fov_deg"))
    throw UsageError("detector: ifov_rad and fov_deg exclude each other");
  if (json.contains("ifov_rad")) {
    const auto [x, y] = pair_of(json.at("ifov_rad"));
    detector.field_of_view = PixelFieldOfView{x, y};
  }
  if (json.contains("fov_deg")) {
    const auto [x, y] = pair_of(json.at("fov_deg"));
    detector.field_of_view = FullFieldOfView{kRadiansPerDegree * x, kRadiansPerDegree * y};
  }
  return perspective_detector(detector);
}

}  // namespace landfall
