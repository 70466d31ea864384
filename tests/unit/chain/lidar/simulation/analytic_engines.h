// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "chain/ray/engine.h"

namespace landfall {

/// An infinite plane z = z0 + slope_x x + slope_y y.
struct Plane {
  double z0_m = 0;
  double slope_x = 0;
  double slope_y = 0;

  [[nodiscard]] double range(const Ray& ray) const {
    const Eigen::Vector3d& p = ray.origin.v;
    const Eigen::Vector3d& d = ray.direction.v;
    const double r =
        (z0_m + slope_x * p.x() + slope_y * p.y() - p.z()) / (d.z() - slope_x * d.x() - slope_y * d.y());
    return r >= 0 ? r : std::numeric_limits<double>::quiet_NaN();
  }
};

class PlaneEngine : public RayEngine {
 public:
  explicit PlaneEngine(Plane plane = {}) : plane_(plane) {}
  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) ranges[i] = plane_.range(rays[i]);
  }

 private:
  Plane plane_;
};

/// The plane z = 0 where x >= edge_m; elsewhere no surface, or a plane at west_z_m (its wall is not seen from
/// above).
class EdgeEngine : public RayEngine {
 public:
  explicit EdgeEngine(double edge_m, double west_z_m = std::numeric_limits<double>::quiet_NaN())
      : edge_m_(edge_m), west_z_m_(west_z_m) {}
  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ranges[i] = Plane{}.range(rays[i]);
      const double x = rays[i].origin.v.x() + ranges[i] * rays[i].direction.v.x();
      if (x < edge_m_) ranges[i] = Plane{west_z_m_}.range(rays[i]);
    }
  }

 private:
  double edge_m_;
  double west_z_m_;
};

/// A plane that records its queries; for one thread.
class RecordingEngine : public PlaneEngine {
 public:
  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    calls.emplace_back(rays.begin(), rays.end());
    PlaneEngine::first_hits(rays, ranges);
  }
  mutable std::vector<std::vector<Ray>> calls;
};

}  // namespace landfall
