// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace landfall {

/// Twice the signed area of the triangle a, b, c in the plane: positive where they turn counter-clockwise, 0
/// only where they are exactly collinear.
///
/// The sign is exact (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates", 1997: a filter, then expansions); the relative error of the value is within 2^-20. Exchanging
/// two points changes only the sign. Coordinates must be finite and below 1e150; differences below 1e-130 may
/// count as 0.
[[nodiscard]] double orient2d(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace landfall
