// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "base/parameter_check.h"
#include "base/portable_math.h"
#include "terrain/features/feature_role.h"
#include "terrain/features/turned_axes.h"

namespace landfall {

/// A pyramid on a square base of edge base_width_m, turned counter-clockwise by yaw_rad:
/// height_m (1 - 2 max(|u|, |v|) / base_width_m), (u, v) the point in the base's own axes.
struct Pyramid {
  static constexpr const char* kName = "pyramid";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double base_width_m = 2;
  double height_m = 1;
  double yaw_rad = 0;

  /// Throws UsageError unless width and height are finite and positive and the yaw finite.
  void validate(const std::string& owner) const {
    require_positive({owner, "base_width_m"}, base_width_m);
    require_positive({owner, "height_m"}, height_m);
    require_finite({owner, "yaw_rad"}, yaw_rad);
  }
  /// Half the diagonal of the base, which covers any yaw.
  [[nodiscard]] double reach_m() const { return portable::hypot(base_width_m, base_width_m) / 2; }
  [[nodiscard]] FeatureSize size() const { return {base_width_m, height_m, yaw_rad}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    return own_relief_m(TurnedAxes(yaw_rad).own(offset));
  }
  [[nodiscard]] double own_relief_m(const Offset& own) const {
    const double edge_frac = 2 * std::max(std::abs(own.x_m), std::abs(own.y_m)) / base_width_m;
    return edge_frac <= 1 ? height_m * (1 - edge_frac) : kNoRelief;
  }
  friend bool operator==(const Pyramid&, const Pyramid&) = default;
};

}  // namespace landfall
