// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/geometry/frames.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// tan(theta), theta the angle between a beam and the normal of the triangle that it hits, at most 89 deg
/// because the slope of a cliff seen edge-on is unbounded. `hit` lies on `terrain`. 0 in or on the edge of a
/// hole, where the triangle is unknown. NaN for a hit that is NaN.
[[nodiscard]] inline double tan_incidence(const TerrainSurface& terrain, const Point<DemFrame>& hit,
                                          const Direction<DemFrame>& beam) {
  constexpr double kSmallestCosine = 0.017452406437283512;  // cosine of 89 deg
  if (!hit.v.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d normal = terrain.normal(hit.v);
  if (!normal.allFinite()) return 0;
  // The cross product resolves small angles, which the cosine does not.
  const double cosine = std::max(std::abs(normal.dot(beam.v)), kSmallestCosine);
  const double sine = std::min(normal.cross(beam.v).norm(), std::sqrt(1 - kSmallestCosine * kSmallestCosine));
  return sine / cosine;
}

}  // namespace landfall
