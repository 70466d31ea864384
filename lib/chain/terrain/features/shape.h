// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D98
#pragma once

#include <algorithm>
#include <limits>
#include <numbers>

#include "base/numerics/portable_math.h"

namespace landfall {

/// A point relative to a feature's centre, metres, axes of frame D.
struct Offset {
  double x_m = 0;
  double y_m = 0;
};

/// How a feature changes the terrain by its relief, its height at a point (docs/reference/decisions.md, D98).
enum class FeatureRole {
  adds,    ///< changes the ground: craters, pits. Where several overlap, their reliefs add up.
  drapes,  ///< follows the ground point by point, as long objects do. Where several overlap, the highest
           ///< counts.
  stands,  ///< rests on the ground under its own centre; visible where it is higher than everything else.
};

/// The relief outside the footprint of a feature.
inline constexpr double kNoRelief = std::numeric_limits<double>::quiet_NaN();

/// An object in a list of objects. Lengths in metres; angles counter-clockwise from +x.
struct FeatureSize {
  double diameter_m = 0;  ///< the greatest extent along the ground; see Rock::law_diameter_m
  double height_m = 0;    ///< above the ground; below it where negative (a crater's depth)
  double yaw_rad = 0;     ///< of the axis with the greatest extent; 0 for a round object

  /// The size of an object `along_m` long in the direction of yaw_rad and `across_m` at a right angle to it.
  [[nodiscard]] static FeatureSize of_rectangle(double along_m, double across_m, double height_m,
                                                double yaw_rad) {
    if (along_m >= across_m) return {along_m, height_m, yaw_rad};
    return {across_m, height_m, yaw_rad + std::numbers::pi / 2};
  }
};

/// The axes (u, v) of an object whose u axis is turned counter-clockwise from +x by a yaw.
class TurnedAxes {
 public:
  explicit TurnedAxes(double yaw_rad) : cos_(portable::cos(yaw_rad)), sin_(portable::sin(yaw_rad)) {}

  /// A point in the object's axes, (u, v).
  [[nodiscard]] Offset own(const Offset& offset) const {
    return {cos_ * offset.x_m + sin_ * offset.y_m, cos_ * offset.y_m - sin_ * offset.x_m};
  }

 private:
  double cos_;
  double sin_;
};

/// A smooth step from 0 on an edge to 1 at `width_m` inside it: t^2 (3 - 2 t), t = inside_m / width_m clamped
/// to [0, 1]. 1 everywhere inside if the width is 0.
[[nodiscard]] inline double taper(double inside_m, double width_m) {
  if (inside_m >= width_m) return 1;
  const double t = std::max(inside_m / width_m, 0.0);
  return t * t * (3 - 2 * t);
}

}  // namespace landfall
