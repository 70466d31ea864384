// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace landfall {

/// A smooth step from 0 on an edge to 1 at `width_m` inside it: t^2 (3 - 2 t), t = inside_m / width_m clamped
/// to [0, 1]. 1 everywhere inside if the width is 0.
[[nodiscard]] inline double taper(double inside_m, double width_m) {
  if (inside_m >= width_m) return 1;
  const double t = std::max(inside_m / width_m, 0.0);
  return t * t * (3 - 2 * t);
}

}  // namespace landfall
