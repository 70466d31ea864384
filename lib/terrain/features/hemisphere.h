// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

#include "terrain/features/ground.h"
#include "base/parameter_check.h"

namespace landfall {

/// Half a ball, flat side down: sqrt(radius_m^2 - r^2) for r <= radius_m.
struct Hemisphere {
  double radius_m = 1;

  /// Throws UsageError unless the radius is finite and positive.
  void validate(const std::string& owner) const { require_positive({owner, "radius_m"}, radius_m); }
  [[nodiscard]] double reach_m() const { return radius_m; }
  [[nodiscard]] double elevation_m(const Ground& ground, const Offset& offset) const {
    const double r_m = std::hypot(offset.x_m, offset.y_m);
    if (r_m > radius_m) return ground.here_m;
    return standing(ground, std::sqrt((radius_m - r_m) * (radius_m + r_m)));
  }
  friend bool operator==(const Hemisphere&, const Hemisphere&) = default;
};

}  // namespace landfall
