// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>

#include "detector/perspective.h"
#include "errors/navigation_error.h"
#include "errors/range_errors.h"
#include "scanner/fsm.h"
#include "scanner/line_search.h"
#include "simulation/simulation.h"
#include "trajectory/constant_velocity.h"

namespace landfall {

/// A trajectory that lives in a file; lib/io/trajectory_table.h reads it.
struct TrajectoryFile {
  std::string path;
};

struct FlashParameters {};

/// A scan configuration (SPEC section 4), degrees turned into radians.
struct ScanConfig {
  PerspectiveParameters detector;
  double pulse_rate_hz = 20000;
  double scan_time_s = 2;
  std::variant<FlashParameters, FsmParameters> scanner = FsmParameters{};
  std::optional<LineSearchParameters> pattern = LineSearchParameters{};
  Transform<BodyFrame, LidarFrame> mount;
  std::variant<ConstantVelocityParameters, TrajectoryFile> trajectory = ConstantVelocityParameters{};
  RangeErrorParameters noise;
  NavigationErrorParameters navigation_error;
  std::uint64_t seed = 1;
};

/// Adds the default that the schema cannot state: the pitch of the pixels, where neither ifov_rad nor fov_deg
/// is given.
void complete_scan_config(nlohmann::json& resolved);

/// `resolved` comes from resolve_config(). Throws UsageError begun by `name` where values do not go together
/// (both ifov_rad and fov_deg).
[[nodiscard]] ScanConfig scan_config(const nlohmann::json& resolved, const std::string& name);

/// Builds the scan that a configuration describes. `trajectory` is what its TrajectoryFile holds, null
/// otherwise. Throws UsageError begun by `name` for parameters out of range.
[[nodiscard]] ScanModel scan_model(const ScanConfig& config, std::unique_ptr<const Trajectory> trajectory,
                                   const std::string& name);

}  // namespace landfall
