// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D7, D35
#include "base/geometry/rotation.h"

#include <cmath>
#include <numbers>

#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

struct SinCos {
  double sin;
  double cos;
};

SinCos sin_cos(double angle_rad) {
  const double quarters = angle_rad / (std::numbers::pi / 2);
  const double nearest = std::nearbyint(quarters);
  if (quarters != nearest || std::abs(nearest) > 8)
    return {portable::sin(angle_rad), portable::cos(angle_rad)};
  constexpr double kSin[] = {0, 1, 0, -1};
  const auto quarter = static_cast<unsigned>((static_cast<int>(nearest) % 4 + 4) % 4);
  return {kSin[quarter], kSin[(quarter + 1) % 4]};
}

}  // namespace

RollPitchYaw linear(const RollPitchYaw& a, double s, const RollPitchYaw& b) {
  return {a.roll_rad + s * b.roll_rad, a.pitch_rad + s * b.pitch_rad, a.yaw_rad + s * b.yaw_rad};
}

Eigen::Matrix3d rotation_matrix(const RollPitchYaw& rpy) {
  const auto [sr, cr] = sin_cos(rpy.roll_rad);
  const auto [sp, cp] = sin_cos(rpy.pitch_rad);
  const auto [sy, cy] = sin_cos(rpy.yaw_rad);
  Eigen::Matrix3d R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

}  // namespace landfall
