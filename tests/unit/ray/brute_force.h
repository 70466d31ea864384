// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "constants.h"
#include "ray/engine.h"
#include "ray/watertight.h"

namespace landfall {

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
    for (std::size_t id = 0; id < terrain_->triangle_count(); ++id)
      best = std::min(best, watertight.range_to(terrain_->triangle(id)));
    return std::isinf(best) ? kNan : best;
  }

  std::shared_ptr<const Surface> terrain_;
};

template <class Surface>
std::unique_ptr<RayEngine> make_brute_force_engine(std::shared_ptr<const Surface> terrain) {
  return std::make_unique<BruteForceEngine<Surface>>(std::move(terrain));
}

}  // namespace landfall
