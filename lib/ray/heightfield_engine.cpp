// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/heightfield_engine.h"

#include <cassert>
#include <limits>
#include <utility>

#include "ray/packet_walk.h"
#include "ray/pyramid_traversal.h"

namespace landfall {
namespace {

class HeightfieldEngine final : public RayEngine {
 public:
  HeightfieldEngine(std::shared_ptr<const TriangulatedGrid> terrain, const ProgressCallback& progress)
      : terrain_(std::move(terrain)), field_(*terrain_, progress) {}

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    walk_packets(field_, rays, ranges);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (ranges[i] == kUndecided) ranges[i] = first_hit(rays[i]);
  }

 private:
  [[nodiscard]] double first_hit(const Ray& ray) const {
    if (!ray.origin.v.allFinite() || !ray.direction.v.allFinite())
      return std::numeric_limits<double>::quiet_NaN();
    return PyramidTraversal(field_, ray).first_hit();
  }

  std::shared_ptr<const TriangulatedGrid> terrain_;
  Heightfield field_;
};

}  // namespace

std::unique_ptr<RayEngine> make_heightfield_engine(std::shared_ptr<const TriangulatedGrid> terrain,
                                                   const ProgressCallback& progress) {
  return std::make_unique<HeightfieldEngine>(std::move(terrain), progress);
}

}  // namespace landfall
