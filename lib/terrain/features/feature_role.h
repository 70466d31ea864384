// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D98
#pragma once

#include <limits>
#include <numbers>

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

}  // namespace landfall
