// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/ray/heightfield_engine.h"

#include <cassert>
#include <limits>
#include <utility>

#include "chain/ray/packet_walk.h"

namespace landfall {
namespace {

double first_hit(const Heightfield& field, const Ray& ray) {
  if (!ray.origin.v.allFinite() || !ray.direction.v.allFinite())
    return std::numeric_limits<double>::quiet_NaN();
  return PyramidTraversal(field, ray).first_hit();
}

class HeightfieldEngine final : public RayEngine {
 public:
  HeightfieldEngine(std::shared_ptr<const TriangulatedGrid> terrain, const ProgressCallback& progress)
      : terrain_(std::move(terrain)), field_(*terrain_, progress) {}

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    walk_packets(field_, rays, ranges);
    trace_undecided(field_, rays, ranges);
  }

 private:
  std::shared_ptr<const TriangulatedGrid> terrain_;
  Heightfield field_;
};

}  // namespace

std::size_t trace_undecided(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (ranges[i] != kUndecided) continue;
    ranges[i] = first_hit(field, rays[i]);
    ++count;
  }
  return count;
}

std::unique_ptr<RayEngine> make_heightfield_engine(std::shared_ptr<const TriangulatedGrid> terrain,
                                                   const ProgressCallback& progress) {
  return std::make_unique<HeightfieldEngine>(std::move(terrain), progress);
}

}  // namespace landfall
