// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/scan_config.h"

#include <array>

#include "base/error.h"
#include "config/json_values.h"
#include "scanner/flash.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// A scalar holds for both axes.
std::array<double, 2> pair_of(const Json& value) {
  if (value.is_array()) return value.get<std::array<double, 2>>();
  return {value.get<double>(), value.get<double>()};
}

PerspectiveParameters detector_of(const Json& json, const std::string& name) {
  PerspectiveParameters detector;
  detector.rows = json.at("rows").get<int>();
  detector.columns = json.at("columns").get<int>();
  detector.subpixels = json.at("subpixels").get<int>();
  detector.roll_rad = kRadiansPerDegree * json.at("roll_deg").get<double>();
  if (json.contains("ifov_rad") && json.contains("fov_deg"))
    throw UsageError(name + ": /detector: ifov_rad and fov_deg exclude each other");
  if (json.contains("ifov_rad")) {
    const auto [x, y] = pair_of(json.at("ifov_rad"));
    detector.field_of_view = PixelFieldOfView{x, y};
  }
  if (json.contains("fov_deg")) {
    const auto [x, y] = pair_of(json.at("fov_deg"));
    detector.field_of_view = FullFieldOfView{kRadiansPerDegree * x, kRadiansPerDegree * y};
  }
  return detector;
}

LineSearchParameters line_search_of(const Json& json) {
  LineSearchParameters pattern;
  pattern.rows = json.at("rows").get<int>();
  pattern.columns = json.at("columns").get<int>();
  pattern.half_width_m = json.at("half_width_m").get<double>();
  pattern.direction =
      json.at("direction") == "boustrophedon" ? LineDirection::boustrophedon : LineDirection::unidirectional;
  pattern.compensated = json.at("compensated").get<bool>();
  pattern.at_end = json.at("at_end") == "stop" ? AtEnd::stop : AtEnd::wrap;
  return pattern;
}

void read_scanner(const Json& json, ScanConfig& config) {
  if (json.at("type") == "flash") {
    config.scanner = FlashParameters{};
    config.pattern.reset();
    return;
  }
  config.scanner = FsmParameters{kRadiansPerDegree * json.at("incidence_deg").get<double>(),
                                 kRadiansPerDegree * json.at("fold_azimuth_deg").get<double>(),
                                 kRadiansPerDegree * json.at("max_deflection_deg").get<double>()};
  config.pattern = line_search_of(json.at("pattern"));
}

std::variant<ConstantVelocityParameters, TrajectoryFile> trajectory_of(const Json& json) {
  if (json.at("type") == "table") return TrajectoryFile{json.at("path").get<std::string>()};
  return ConstantVelocityParameters{{vector3(json.at("position_m"))},
                                    {vector3(json.at("velocity_mps"))},
                                    roll_pitch_yaw(json.at("rpy_deg"), kRadiansPerDegree),
                                    roll_pitch_yaw(json.at("rpy_rate_degps"), kRadiansPerDegree)};
}

RangeErrorParameters noise_of(const Json& json) {
  return {json.at("range_sigma_m").get<double>(), json.at("range_bias_m").get<double>(),
          json.at("dead_pixel_frac").get<double>(), json.at("dropout_frac").get<double>()};
}

NavigationErrorParameters navigation_error_of(const Json& json) {
  return {{vector3(json.at("position_m"))},
          {vector3(json.at("velocity_mps"))},
          roll_pitch_yaw(json.at("rpy_rad"), 1),
          roll_pitch_yaw(json.at("rpy_rate_radps"), 1)};
}

std::unique_ptr<const Scanner> make_scanner(const ScanConfig& config) {
  if (const auto* const fsm = std::get_if<FsmParameters>(&config.scanner)) return std::make_unique<Fsm>(*fsm);
  return std::make_unique<Flash>();
}

std::unique_ptr<const Trajectory> make_trajectory(const ScanConfig& config) {
  return std::make_unique<ConstantVelocity>(std::get<ConstantVelocityParameters>(config.trajectory));
}

}  // namespace

void complete_scan_config(Json& resolved) {
  Json& detector = resolved.at("detector");
  if (!detector.contains("ifov_rad") && !detector.contains("fov_deg"))
    detector["ifov_rad"] = PixelFieldOfView{}.x_rad;
}

ScanConfig scan_config(const Json& resolved, const std::string& name) {
  ScanConfig config;
  config.detector = detector_of(resolved.at("detector"), name);
  config.pulse_rate_hz = resolved.at("laser").at("pulse_rate_hz").get<double>();
  config.scan_time_s = resolved.at("laser").at("scan_time_s").get<double>();
  read_scanner(resolved.at("scanner"), config);
  const Json& mount = resolved.at("mount");
  config.mount = {
      rotation_from<BodyFrame, LidarFrame>(roll_pitch_yaw(mount.at("rpy_deg"), kRadiansPerDegree)),
      {vector3(mount.at("position_m"))}};
  config.trajectory = trajectory_of(resolved.at("trajectory"));
  config.noise = noise_of(resolved.at("noise"));
  config.navigation_error = navigation_error_of(resolved.at("navigation_error"));
  config.seed = resolved.at("seed").get<std::uint64_t>();
  return config;
}

ScanModel scan_model(const ScanConfig& config, std::unique_ptr<const Trajectory> trajectory,
                     const std::string& name) {
  try {
    std::unique_ptr<const Pattern> pattern;
    if (config.pattern) pattern = std::make_unique<LineSearch>(*config.pattern);
    ScanModel model{{perspective_detector(config.detector), make_scanner(config), std::move(pattern),
                     config.mount, RangeErrors(config.noise, config.seed)},
                    trajectory ? std::move(trajectory) : make_trajectory(config),
                    std::make_unique<LinearNavigationError>(config.navigation_error),
                    config.pulse_rate_hz,
                    config.scan_time_s};
    static_cast<void>(pulse_count(model));
    return model;
  } catch (const UsageError& error) {
    throw UsageError(name + ": /" + error.what());
  }
}

}  // namespace landfall
