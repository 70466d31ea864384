// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/geodetic.h"

#include <cmath>
#include <limits>

namespace landfall {

Geodetic geodetic_of(const Ellipsoid& body, const Eigen::Vector3d& p) {
  constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();
  if (p.isZero(0)) return {{kNoPlace, kNoPlace}, kNoPlace};
  const double a = body.semi_major_m;
  const double axis_ratio = 1 - body.flattening;
  const double b = a * axis_ratio;
  const double e2 = body.flattening * (2 - body.flattening);
  const double axis_distance = portable::hypot(p.x(), p.y());
  // Bowring (1976): the parametric latitude, which is exact at once for points of the surface.
  double lat_rad = 0;
  double parametric = portable::atan2(a * p.z(), b * axis_distance);
  constexpr int kMaxSteps = 20;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double s = portable::sin(parametric);
    const double c = portable::cos(parametric);
    lat_rad = portable::atan2(p.z() + e2 / (1 - e2) * b * s * s * s, axis_distance - e2 * a * c * c * c);
    const double next = portable::atan2(axis_ratio * portable::sin(lat_rad), portable::cos(lat_rad));
    const bool is_settled = std::abs(next - parametric) < 1e-15;
    parametric = next;
    if (is_settled) break;
  }
  const double s = portable::sin(lat_rad);
  const double height_m = axis_distance * portable::cos(lat_rad) + p.z() * s - a * std::sqrt(1 - e2 * s * s);
  return {{portable::atan2(p.y(), p.x()), lat_rad}, height_m};
}

}  // namespace landfall
