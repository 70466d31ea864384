// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "chain/ray/engine.h"
#include "chain/ray/watertight.h"
#include "constants.h"

namespace landfall {

/// Whether a triangle certainly passes the ray on one side: most do, and quadruple precision is slow.
inline bool lies_beside(const Ray& ray, const std::array<Eigen::Vector3d, 3>& corners) {
  constexpr double kMargin = 1e-12;  // much more than the rounding of the offsets
  Eigen::Index along = 0;
  ray.direction.v.cwiseAbs().maxCoeff(&along);
  for (const Eigen::Index across : {(along + 1) % 3, (along + 2) % 3}) {
    const double slope = ray.direction.v[across] / ray.direction.v[along];
    int above = 0, below = 0;
    for (const Eigen::Vector3d& corner : corners) {
      const Eigen::Vector3d at = corner - ray.origin.v;
      const double offset = at[across] - slope * at[along];
      const double margin = kMargin * (std::abs(at[across]) + std::abs(at[along]));
      above += offset > margin;
      below += offset < -margin;
    }
    if (above == 3 || below == 3) return true;
  }
  return false;
}

/// The oracle of the engines: tests each ray against every triangle of a surface, with WatertightRay. A ray
/// that is not finite misses. O(triangles) per ray.
template <class Surface>
class BruteForceEngine final : public RayEngine {
 public:
  explicit BruteForceEngine(std::shared_ptr<const Surface> terrain) : terrain_(std::move(terrain)) {}

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    std::transform(rays.begin(), rays.end(), ranges.begin(), [&](const Ray& ray) { return first_hit(ray); });
  }

 private:
  [[nodiscard]] double first_hit(const Ray& ray) const {
    if (!ray.origin.v.allFinite() || !ray.direction.v.allFinite()) return kNan;
    const WatertightRay watertight(ray);
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t id = 0; id < terrain_->triangle_count(); ++id) {
      const auto corners = terrain_->triangle(id);
      if (!lies_beside(ray, corners)) best = std::min(best, watertight.range_to(corners));
    }
    return std::isinf(best) ? kNan : best;
  }

  std::shared_ptr<const Surface> terrain_;
};

template <class Surface>
std::unique_ptr<RayEngine> make_brute_force_engine(std::shared_ptr<const Surface> terrain) {
  return std::make_unique<BruteForceEngine<Surface>>(std::move(terrain));
}

}  // namespace landfall
