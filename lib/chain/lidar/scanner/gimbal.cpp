// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D72
#include "chain/lidar/scanner/gimbal.h"

#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"
#include "chain/lidar/scanner/mechanism.h"

namespace landfall {
namespace {

double checked_limit(double max_deflection_rad) {
  require_angle(max_deflection_rad > 0 && max_deflection_rad < std::numbers::pi / 2,
                {"", "max_deflection_deg"}, max_deflection_rad, "in (0, 90)");
  return max_deflection_rad;
}

}  // namespace

Eigen::Matrix3d gimbal_rotation(const TiltAngles& angles) {
  const double s1 = portable::sin(angles.angle_1_rad);
  const double c1 = portable::cos(angles.angle_1_rad);
  const double s2 = portable::sin(angles.angle_2_rad);
  const double c2 = portable::cos(angles.angle_2_rad);
  return Eigen::Matrix3d{{c2, 0, s2}, {s1 * s2, c1, -s1 * c2}, {-c1 * s2, s1, c1 * c2}};
}

TiltAngles gimbal_angles(const Direction<LidarFrame>& aim) {
  return {portable::atan2(-aim.v.y(), aim.v.z()),
          portable::atan2(aim.v.x(), portable::hypot(aim.v.y(), aim.v.z()))};
}

Gimbal::Gimbal(const GimbalParameters& parameters)
    : limit_(checked_limit(parameters.max_deflection_rad)),
      timing_(parameters.timing),
      encoder_harmonics_(parameters.encoder_harmonics) {
  check(encoder_harmonics_);
}

ScannerState Gimbal::state(const PulseContext& pulse) const {
  if (!pulse.aim) return {};
  limit_.require_within(*pulse.aim, pulse.time.pulse);
  TiltAngles angles = gimbal_angles(*pulse.aim);
  const double left = timing_.step_left(pulse.since_jump_s);
  if (left != 0 && pulse.aim_before_jump)
    angles = between(angles, left, gimbal_angles(*pulse.aim_before_jump));
  return {.angle_1_rad = angles.angle_1_rad,
          .angle_2_rad = angles.angle_2_rad,
          .blanked = timing_.blanks(pulse.since_jump_s) ||
                     (pulse.jump_aims &&
                      timing_.is_moving(pulse.since_jump_s, axes_jump(*pulse.jump_aims, gimbal_angles)))};
}

ScannerState Gimbal::estimated_state(const PulseContext&, const ScannerState& truth) const {
  const TiltAngles error = encoder_error(encoder_harmonics_, {truth.angle_1_rad, truth.angle_2_rad});
  ScannerState estimated = truth;
  estimated.angle_1_rad += error.angle_1_rad;
  estimated.angle_2_rad += error.angle_2_rad;
  return estimated;
}

void Gimbal::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                   std::span<Beam> beams) const {
  const Eigen::Matrix3d rotation = gimbal_rotation({state.angle_1_rad, state.angle_2_rad});
  rotate_all(rotation, pixels, beams);
}

}  // namespace landfall
