// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

#include "terrain/features/ground.h"
#include "base/parameter_check.h"

namespace landfall {

/// A right circular cone: height_m (1 - r / radius_m) for r <= radius_m.
struct Cone {
  double radius_m = 3;
  double height_m = 10;

  /// Throws UsageError unless both are finite and positive.
  void validate(const std::string& owner) const {
    require_positive({owner, "radius_m"}, radius_m);
    require_positive({owner, "height_m"}, height_m);
  }
  [[nodiscard]] double reach_m() const { return radius_m; }
  [[nodiscard]] double elevation_m(const Ground& ground, const Offset& offset) const {
    const double r_m = std::hypot(offset.x_m, offset.y_m);
    return r_m <= radius_m ? standing(ground, height_m * (1 - r_m / radius_m)) : ground.here_m;
  }
  friend bool operator==(const Cone&, const Cone&) = default;
};

}  // namespace landfall
