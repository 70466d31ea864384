// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/heightfield_engine.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "ray/descent.h"

namespace landfall {
namespace {

class HeightfieldEngine final : public RayEngine {
 public:
  explicit HeightfieldEngine(std::shared_ptr<const TriangulatedGrid> terrain)
      : terrain_(std::move(terrain)), field_(*terrain_) {}

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    std::transform(rays.begin(), rays.end(), ranges.begin(), [&](const Ray& ray) { return first_hit(ray); });
  }

 private:
  [[nodiscard]] double first_hit(const Ray& ray) const {
    if (!ray.origin.v.allFinite() || !ray.direction.v.allFinite())
      return std::numeric_limits<double>::quiet_NaN();
    return Descent(field_, ray).first_hit();
  }

  std::shared_ptr<const TriangulatedGrid> terrain_;
  Heightfield field_;
};

}  // namespace

std::unique_ptr<RayEngine> make_heightfield_engine(std::shared_ptr<const TriangulatedGrid> terrain) {
  return std::make_unique<HeightfieldEngine>(std::move(terrain));
}

}  // namespace landfall
