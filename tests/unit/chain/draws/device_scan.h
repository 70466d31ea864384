// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "plane_terrain.h"

namespace landfall {

/// 40,000 pulses of 3 x 2 pixels by default, some of them beyond the map.
inline ScanModel device_scan(const RangeErrorParameters& errors, std::uint64_t seed, int columns = 2) {
  ScanModel model{.lidar = {.detector = perspective_detector({.rows = 3, .columns = columns}),
                            .scanner = std::make_unique<Fsm>(FsmParameters{}),
                            .pattern = std::make_unique<LineSearch>(LineSearchParameters{.half_width_m = 6}),
                            .range_errors = RangeErrors(errors, seed)},
                  .trajectory = std::make_unique<ConstantVelocity>(ConstantVelocityParameters{})};
  model.navigation_error = std::make_unique<LinearNavigationError>(NavigationErrorParameters{
      .position_m = {{0.3, 0, 0}}, .velocity_mps = {{0.1, -0.2, 0.3}}, .rpy = {1e-3, -2e-3, 3e-3}});
  return model;
}

/// The truth of device_scan() over kPlane; one in ten is a miss.
inline std::vector<double> device_scan_ranges(int columns = 2) {
  const PlaneEngine engine(kPlane);
  const Simulation traced(device_scan({}, 1, columns), &engine);
  std::vector<double> ranges = traced.simulate({0, traced.pulse_count()}).points.range_true;
  std::mt19937_64 random(7);
  for (double& range : ranges)
    if (random() % 10 == 0) range = std::nan("");
  return ranges;
}

}  // namespace landfall
