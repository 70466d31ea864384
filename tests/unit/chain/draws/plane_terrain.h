// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "chain/lidar/simulation/analytic_engines.h"

namespace landfall {

inline constexpr Plane kPlane{1, 0.1, -0.2};

/// The plane, east of x = -4 m.
class PlaneTerrain final : public TerrainSurface {
 public:
  [[nodiscard]] double elevation(double x_m, double y_m) const override {
    return x_m < -4 ? std::nan("") : kPlane.z0_m + kPlane.slope_x * x_m + kPlane.slope_y * y_m;
  }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& /*point*/) const override {
    return Eigen::Vector3d(-kPlane.slope_x, -kPlane.slope_y, 1).normalized();
  }
};

}  // namespace landfall
