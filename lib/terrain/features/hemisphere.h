// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

#include "base/parameter_check.h"
#include "base/portable_math.h"
#include "terrain/features/feature_role.h"

namespace landfall {

/// A hemisphere, flat side down: sqrt(radius_m^2 - r^2) for r <= radius_m.
struct Hemisphere {
  static constexpr const char* kName = "hemisphere";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double radius_m = 1;

  /// Throws UsageError unless the radius is finite and positive.
  void validate(const std::string& owner) const { require_positive({owner, "radius_m"}, radius_m); }
  [[nodiscard]] double reach_m() const { return radius_m; }
  [[nodiscard]] FeatureSize size() const { return {2 * radius_m, radius_m, 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    const double r_m = portable::hypot(offset.x_m, offset.y_m);
    return r_m <= radius_m ? std::sqrt((radius_m - r_m) * (radius_m + r_m)) : kNoRelief;
  }
  friend bool operator==(const Hemisphere&, const Hemisphere&) = default;
};

}  // namespace landfall
