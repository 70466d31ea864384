// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// The two angles of a two-axis mechanism, radians: the outer axis turns by angle_1 and carries the inner
/// one, which turns by angle_2.
struct TiltAngles {
  double angle_1_rad = 0;
  double angle_2_rad = 0;
  friend bool operator==(const TiltAngles&, const TiltAngles&) = default;
};

/// Linear interpolation a + s (b - a) of each angle.
inline TiltAngles between(const TiltAngles& a, double s, const TiltAngles& b) {
  return {a.angle_1_rad + s * (b.angle_1_rad - a.angle_1_rad),
          a.angle_2_rad + s * (b.angle_2_rad - a.angle_2_rad)};
}

}  // namespace landfall
