// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/parameter_check.h"
#include "base/portable_math.h"
#include "terrain/features/feature_role.h"

namespace landfall {

/// A right circular cone: height_m (1 - r / radius_m) for r <= radius_m.
struct Cone {
  static constexpr const char* kName = "cone";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double radius_m = 3;
  double height_m = 10;

  /// Throws UsageError unless both are finite and positive.
  void validate(const std::string& owner) const {
    require_positive({owner, "radius_m"}, radius_m);
    require_positive({owner, "height_m"}, height_m);
  }
  [[nodiscard]] double reach_m() const { return radius_m; }
  [[nodiscard]] FeatureSize size() const { return {2 * radius_m, height_m, 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    const double r_m = portable::hypot(offset.x_m, offset.y_m);
    return r_m <= radius_m ? height_m * (1 - r_m / radius_m) : kNoRelief;
  }
  friend bool operator==(const Cone&, const Cone&) = default;
};

}  // namespace landfall
