// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "chain/ray/engine.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// Infinite level terrain, z = elevation_m: range = (elevation - o_z) / d_z in closed form, exact to
/// rounding. Rays that are level or point away from the ground miss.
class FlatTerrain final : public TerrainSurface, public RayEngine {
 public:
  explicit FlatTerrain(double elevation_m = 0) : elevation_m_(elevation_m) {}
  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      // A level ray gives an infinite range, or NaN if its origin lies in the plane.
      const double range = (elevation_m_ - rays[i].origin.v.z()) / rays[i].direction.v.z();
      const bool hits = range >= 0 && range <= std::numeric_limits<double>::max();
      ranges[i] = hits ? range : std::numeric_limits<double>::quiet_NaN();
    }
  }
  [[nodiscard]] double elevation(double /*x_m*/, double /*y_m*/) const override { return elevation_m_; }
  [[nodiscard]] double highest_m() const override { return elevation_m_; }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& /*point*/) const override {
    return Eigen::Vector3d::UnitZ();
  }

 private:
  double elevation_m_;
};

}  // namespace landfall
