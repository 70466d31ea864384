// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

#include "base/parameter_check.h"
#include "terrain/features/feature_role.h"
#include "terrain/features/turned_axes.h"

namespace landfall {

/// The part of a half-buried ellipsoid above the ground: height_m sqrt(1 - (u / a)^2 - (v / b)^2), with the
/// horizontal semi-axes a = diameter_m / 2 along the yaw and b = axis_ratio a across it.
struct Rock {
  static constexpr const char* kName = "rock";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double diameter_m = 1;
  double height_m = 0.5;
  double axis_ratio = 0.8;
  double yaw_rad = 0;
  /// The diameter in the size law, of a rock that one gives, which is that of a disc of the same area.
  /// None, 0, means diameter_m.
  double law_diameter_m = 0;

  /// Throws UsageError unless diameter and height are finite and positive, the ratio is in (0, 1] and the yaw
  /// finite.
  void validate(const std::string& owner) const {
    require_positive({owner, "diameter_m"}, diameter_m);
    require_positive({owner, "height_m"}, height_m);
    require(axis_ratio > 0 && axis_ratio <= 1, {owner, "axis_ratio"}, axis_ratio, "in (0, 1]");
    require_finite({owner, "yaw_rad"}, yaw_rad);
  }
  [[nodiscard]] double reach_m() const { return diameter_m / 2; }
  [[nodiscard]] FeatureSize size() const {
    return {law_diameter_m > 0 ? law_diameter_m : diameter_m, height_m, yaw_rad};
  }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    return own_relief_m(TurnedAxes(yaw_rad).own(offset));
  }
  [[nodiscard]] double own_relief_m(const Offset& own) const {
    const double a_m = diameter_m / 2;
    const double u = own.x_m / a_m;
    const double v = own.y_m / (axis_ratio * a_m);
    const double r2 = u * u + v * v;
    return r2 <= 1 ? height_m * std::sqrt(1 - r2) : kNoRelief;
  }
  friend bool operator==(const Rock&, const Rock&) = default;
};

}  // namespace landfall
