// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/incidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace landfall {
namespace {

constexpr double kSmallestCosine = 0.017452406437283512;  // cosine of 89 deg

}  // namespace

double tan_incidence(const TerrainSurface& ground, const Point<DemFrame>& hit,
                     const Direction<DemFrame>& beam) {
  if (!hit.v.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d normal = ground.normal(hit.v);
  if (!normal.allFinite()) return 0;
  // The cross product resolves small angles, which the cosine does not.
  const double cosine = std::max(std::abs(normal.dot(beam.v)), kSmallestCosine);
  const double sine = std::min(normal.cross(beam.v).norm(), std::sqrt(1 - kSmallestCosine * kSmallestCosine));
  return sine / cosine;
}

}  // namespace landfall
