// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/palmer.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/geometry/rotation_vector.h"
#include "base/geometry/vector_check.h"

namespace landfall {
namespace {

using std::numbers::pi;

void check_palmer(const PalmerParameters& p) {
  require_angle(p.tilt_rad >= 0 && p.tilt_rad + p.incidence_rad < pi / 2, {"", "tilt_deg"}, p.tilt_rad,
                ">= 0 and below 90 - incidence_deg");
  require_positive({"", "rate_hz"}, p.rate_hz);
  require_finite({"", "phase_deg"}, p.phase_rad);
}

}  // namespace

Palmer::Palmer(const PalmerParameters& parameters)
    : parameters_(parameters),
      mirror_(parameters.incidence_rad, parameters.fold_azimuth_rad),
      tilted_(mirror_.normal({parameters.tilt_rad, 0}).v) {
  check_palmer(parameters);
}

ScannerState Palmer::state(const PulseContext& pulse) const {
  const double turns = parameters_.rate_hz * pulse.time.since_start_s + parameters_.phase_rad / (2 * pi);
  const double phi = 2 * pi * (turns - std::floor(turns));
  return {.angle_1_rad = phi,
          .mirror_normal = {quaternion_of(phi * mirror_.resting().v).toRotationMatrix() * tilted_}};
}

void Palmer::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                   std::span<Beam> beams) const {
  const Eigen::Matrix3d rotation = mirror_.steering(state.mirror_normal);
  rotate_all(rotation, pixels, beams);
}

}  // namespace landfall
