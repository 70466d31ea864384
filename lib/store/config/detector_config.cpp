// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/error.h"
#include "chain/lidar/detector/perspective.h"
#include "store/config/json_values.h"
#include "store/config/scan_components.h"

namespace landfall {

namespace {

using Json = nlohmann::json;

/// Empty if pixels are evenly spaced, or if the configuration is only checked and no table is read.
std::vector<ImagePoint> image_points(const Json& json, const ComponentContext& context) {
  const Json& distribution = json.at("distribution");
  if (!distribution.is_object() || !context.load_table) return {};
  const NumberTable table =
      context.load_table(distribution.at("path").get<std::string>(), "pixels", pixel_table_columns());
  return pixel_points(table, json.at("rows").get<int>(), json.at("columns").get<int>());
}

/// No distortion if the directions are in a table that is not read: whether they fold is then unknown.
RadialDistortion distortion_of(const Json& json, const ComponentContext& context) {
  if (json.at("distribution").is_object() && !context.load_table) return {};
  const Json& distortion = json.at("distortion");
  return {distortion.at("k1").get<double>(), distortion.at("k2").get<double>(),
          distortion.at("k3").get<double>()};
}

RangeRule range_rule_of(const Json& name) {
  if (name == "first") return RangeRule::first;
  if (name == "median") return RangeRule::median;
  if (name == "strongest") return RangeRule::strongest;
  return RangeRule::mean;
}

}  // namespace

Detector make_detector(const Json& json, const ComponentContext& context) {
  PerspectiveParameters detector;
  detector.rows = json.at("rows").get<int>();
  detector.columns = json.at("columns").get<int>();
  detector.subpixels = json.at("subpixels").get<int>();
  detector.roll_rad = radians(json, "roll_deg");
  if (json.contains("ifov_rad") && json.contains("fov_deg"))
    throw UsageError("fov_deg: excludes ifov_rad; give one of them");
  if (json.contains("ifov_rad")) {
    const auto [x, y] = pair_of(json.at("ifov_rad"));
    detector.field_of_view = PixelFieldOfView{x, y};
  }
  if (json.contains("fov_deg")) {
    const auto [x, y] = pair_of(json.at("fov_deg"));
    detector.field_of_view = FullFieldOfView{kRadiansPerDegree * x, kRadiansPerDegree * y};
  }
  detector.fill_factor = json.at("fill_factor").get<double>();
  detector.points = image_points(json, context);
  detector.distortion = distortion_of(json, context);
  detector.estimator = {range_rule_of(json.at("estimator")), json.at("range_resolution_m").get<double>()};
  return perspective_detector(detector);
}

}  // namespace landfall
