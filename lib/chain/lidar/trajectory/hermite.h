// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace landfall {

/// An end of a cubic Hermite piece: its value, and its rate times the length of the piece.
struct HermiteEnd {
  Eigen::Vector3d value;
  Eigen::Vector3d slope;
};

/// The piece at u in [0, 1], computed from both ends so that u = 0 and u = 1 reproduce them exactly.
[[nodiscard]] inline Eigen::Vector3d hermite(double u, const HermiteEnd& a, const HermiteEnd& b) {
  const double w = u * u * (3 - 2 * u);
  const Eigen::Vector3d bend = (u * (1 - u)) * ((1 - u) * a.slope - u * b.slope);
  return ((1 - w) * a.value + w * b.value) + bend;
}

}  // namespace landfall
