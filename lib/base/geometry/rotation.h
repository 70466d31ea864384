// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/geometry/frames.h"

namespace landfall {

/// Roll, pitch, yaw about x, y, z, radians.
struct RollPitchYaw {
  double roll_rad = 0;
  double pitch_rad = 0;
  double yaw_rad = 0;
  friend bool operator==(const RollPitchYaw&, const RollPitchYaw&) = default;
};

/// a + s b for each angle: attitude that is linear in time.
[[nodiscard]] RollPitchYaw linear(const RollPitchYaw& a, double s, const RollPitchYaw& b);

/// R = Rz(yaw) Ry(pitch) Rx(roll) (aerospace 3-2-1; D7). Exact at multiples of pi/2:
/// the entries are then -1, 0 and 1, so that the nominal mount, rpy = (180, 0, 0) deg, is exactly
/// diag(1, -1, -1).
[[nodiscard]] Eigen::Matrix3d rotation_matrix(const RollPitchYaw& rpy);

template <class To, class From>
[[nodiscard]] Rotation<To, From> rotation_from(const RollPitchYaw& rpy) {
  return {rotation_matrix(rpy)};
}

}  // namespace landfall
