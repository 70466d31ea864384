// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/parameter_check.h"
#include "base/portable_math.h"
#include "terrain/features/feature_role.h"

namespace landfall {

/// A round hole without a rim: -min(depth_m, (diameter_m / 2 - r) tan wall_slope) for r <= diameter_m / 2.
/// The floor is level; walls that meet before depth_m form a cone. A wall of 90 deg falls within one cell.
struct Pit {
  static constexpr const char* kName = "pit";
  static constexpr FeatureRole kRole = FeatureRole::adds;

  double diameter_m = 10;
  double depth_m = 5;
  double wall_slope_rad = std::numbers::pi / 2;  ///< from the horizontal

  /// Throws UsageError unless diameter and depth are finite and positive and the slope in (0, pi/2].
  void validate(const std::string& owner) const {
    require_positive({owner, "diameter_m"}, diameter_m);
    require_positive({owner, "depth_m"}, depth_m);
    require(wall_slope_rad > 0 && wall_slope_rad <= std::numbers::pi / 2, {owner, "wall_slope_rad"},
            wall_slope_rad, "in (0, pi/2]");
  }
  [[nodiscard]] double reach_m() const { return diameter_m / 2; }
  [[nodiscard]] FeatureSize size() const { return {diameter_m, relief_m({}), 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    const double inside_m = diameter_m / 2 - portable::hypot(offset.x_m, offset.y_m);
    return inside_m >= 0 ? -std::min(depth_m, inside_m * std::abs(portable::tan(wall_slope_rad))) : kNoRelief;
  }
  friend bool operator==(const Pit&, const Pit&) = default;
};

}  // namespace landfall
