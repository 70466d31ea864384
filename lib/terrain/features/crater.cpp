// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D105, D106, D107, D254
#include "terrain/features/crater.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"
#include "base/portable_math.h"

namespace landfall {

double Crater::fresh_depth_m(double diameter_m) {
  struct SizeClass {
    double from_m;
    double depth_per_diameter;
  };
  constexpr SizeClass kClasses[] = {{400, 0.21}, {200, 0.17}, {100, 0.15}, {40, 0.13}, {10, 0.11}};
  for (const SizeClass& size : kClasses)
    if (diameter_m >= size.from_m) return size.depth_per_diameter * diameter_m;
  return 0.10 * diameter_m;
}

void Crater::validate(const std::string& owner) const {
  require_positive({owner, "diameter_m"}, diameter_m);
  const double max_m = kDeepestPerDiameter * diameter_m;
  require(depth_m >= 0 && depth_m <= max_m, {owner, "depth_m"}, depth_m,
          ("in [0, " + number_text(max_m) + "]: the profile's depth is 0.2656 diameters").c_str());
  require(freshness > 0 && freshness <= 1, {owner, "freshness"}, freshness, "in (0, 1]");
}

double Crater::relief_m(const Offset& offset) const {
  const double x = portable::hypot(offset.x_m, offset.y_m) / (diameter_m / 2);
  if (x > 1.5) return kNoRelief;
  const double depth = full_depth_m() / diameter_m;
  const double height = std::min(depth / kFullRimDepthPerDiameter, 1.0);  // of the profile, 1: as published
  const double scale_m = freshness * diameter_m * height;
  if (x > 1.02) return scale_m * (0.188253307 + x * (-0.187050452 + x * (0.01844746 + x * 0.01505647)));
  if (x > 0.98) return scale_m * kRimPerDiameter;
  const double bowl = -0.228809953 + x * (0.227533882 + x * (0.083116795 - x * 0.039499407));
  return scale_m * std::max(bowl, kRimPerDiameter - depth / height);
}

}  // namespace landfall
