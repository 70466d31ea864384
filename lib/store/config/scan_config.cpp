// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/scan_config.h"

#include <algorithm>
#include <utility>

#include "base/core/error.h"
#include "chain/lidar/detector/perspective.h"
#include "store/config/config_path.h"
#include "store/config/json_values.h"
#include "store/config/receiver_config.h"
#include "store/config/scan_components.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

Transform<BodyFrame, LidarFrame> mount_of(const Json& mount) {
  return {rotation_from<BodyFrame, LidarFrame>(roll_pitch_yaw(mount.at("rpy_deg"), kRadiansPerDegree)),
          {vector3(mount.at("position_m"))}};
}

/// Extends the time span: poses are also needed at the pulses' times plus their time-stamp errors.
ComponentContext until_last_stamp(ComponentContext context, const PointingError& pointing) {
  context.scan_time_s += std::max(0.0, pointing.largest_time_stamp_error_s());
  return context;
}

AttitudeKnowledge attitude_knowledge_of(const Json& navigation_error) {
  return navigation_error.at("attitude") == "commanded" ? AttitudeKnowledge::commanded
                                                        : AttitudeKnowledge::truth;
}

/// Whether the pattern aims from the estimated poses.
bool aims_from_estimate(const Json& scanner) {
  if (!scanner.contains("pattern") || scanner["pattern"].at("aim") == "nominal") return false;
  if (!scanner["pattern"].at("compensated"))
    throw UsageError("aim: \"estimate\" needs /scanner/pattern/compensated true");
  return true;
}

ScanModel build(const Json& resolved, const TableLoader& load_table) {
  const Json& laser = resolved.at("laser");
  const ComponentContext context{load_table, random_seed(resolved), laser.at("scan_time_s").get<double>(),
                                 1 / laser.at("pulse_rate_hz").get<double>()};
  const Json& scanner = resolved.at("scanner");
  const Json& navigation = resolved.at("navigation_error");
  const auto make = [&](const char* part, const auto& maker, const ComponentContext& needed) {
    return at_path(std::string(part) + "/", [&] { return maker(resolved.at(part), needed); });
  };
  const PointingError pointing = make("pointing_error", make_pointing_error, context);
  const ComponentContext stamped = until_last_stamp(context, pointing);
  Detector detector = make("detector", make_detector, context);
  std::vector<double> link_constants = make_link_constants(resolved, detector);
  std::unique_ptr<const Trajectory> path = make("trajectory", make_trajectory, stamped);
  ScanModel model{
      {std::move(detector), make("scanner", make_scanner, context),
       at_path("scanner/pattern/", [&] { return make_pattern(scanner, context); }),
       mount_of(resolved.at("mount")), make("noise", make_range_errors, context), pointing,
       make_receiver(resolved, context), make_range_timer(resolved, context), std::move(link_constants)},
      at_path("trajectory_dispersion/",
              [&] { return dispersed(std::move(path), resolved.at("trajectory_dispersion")); }),
      make("navigation_error", make_navigation_error, stamped),
      laser.at("pulse_rate_hz").get<double>(),
      context.scan_time_s,
      make("navigation_error", make_estimate, context),
      attitude_knowledge_of(navigation),
      at_path("scanner/pattern/", [&] { return aims_from_estimate(scanner); })};
  static_cast<void>(at_path("laser/", [&] { return pulse_count(model); }));
  return model;
}

/// Prisms either rotate uniformly or follow a pattern; the two cases have different defaults.
void complete_risley(Json& scanner) {
  const bool steered = scanner.contains("pattern");
  const Json defaults =
      steered ? Json{{"branch", "positive"}} : Json{{"rates_hz", {100, -61.8}}, {"phases_deg", {0, 0}}};
  for (const auto& [key, value] : defaults.items())
    if (!scanner.contains(key)) scanner[key] = value;
}

}  // namespace

Json completed_scan_config(Json resolved) {
  Json& detector = resolved.at("detector");
  if (!detector.contains("ifov_rad") && !detector.contains("fov_deg"))
    detector["ifov_rad"] = PixelFieldOfView{}.x_rad;
  Json& scanner = resolved.at("scanner");
  if (scanner.at("type") == "risley") complete_risley(scanner);
  if (!scanner.contains("pattern")) return resolved;
  Json& pattern = scanner.at("pattern");
  if (pattern.at("type") == "spiral" && !pattern.contains("period_s"))
    pattern["period_s"] = resolved.at("laser").at("scan_time_s");
  return resolved;
}

ScanModel scan_model(const Json& resolved, const std::string& name, const TableLoader& load_table) {
  return at_path(name + ": /", [&] { return build(resolved, load_table); });
}

}  // namespace landfall
