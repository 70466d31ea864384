// SPDX-License-Identifier: GPL-3.0-or-later
// Two code paths, the same result. The SIMD lanes decide a ray only if rounding cannot matter, and then
// give the same result as the scalar path, bit for bit. The other rays, mostly those that start on a node
// or pass through one, are left to the scalar path.
//
// Prefetching. Rays come in bundles of 64, each prepared before the previous bundle is traced: the nodes
// and bounds of the cells under it (up to 8192 cells) are prefetched. This gives 30 % more rays per second
// from above. A second traversal, with all lanes of a vector on a common level, gave no further gain from
// above and was not kept.
#include "chain/ray/packet_walk.h"

#include <algorithm>
#include <cassert>

#include "chain/ray/walk_data.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/ray/packet_walk.cpp"
#include "base/numerics/lanes-inl.h"
#include "chain/ray/lane_walk-inl.h"
#include "chain/ray/ray_chunk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Interleaved walks: one waits for memory while the other computes.
constexpr std::size_t kWalks = 2;

/// Steps from block to block, after which the lanes still walking are left to PyramidTraversal.
constexpr int kMaxSteps = 4096;

HWY_INLINE void WalkTogether(const WalkTerrain& terrain, LaneWalk (&walks)[kWalks], bool searching) {
  bool active = true;
  for (int steps = 0; active && steps < kMaxSteps;) {
    for (; searching && steps < kMaxSteps; ++steps) {
      searching = false;
      for (LaneWalk& walk : walks) searching |= walk.step(terrain);
    }
    active = false;
    for (LaneWalk& walk : walks) active |= walk.find_range(terrain);
    searching = active;
  }
}

/// A chunk of rays ready to walk.
struct Bundle {
  RayChunk chunk;
  std::size_t end;  ///< rays in whole groups of walks
  HeightSlab slab;
};

void Prepare(const Heightfield& field, const WalkTerrain& terrain, std::span<const Ray> rays,
             Bundle& bundle) {
  const std::size_t group = kWalks * hn::Lanes(D());
  bundle.end = (rays.size() + group - 1) / group * group;
  FillChunk(field.frame, rays, bundle.end, bundle.chunk);
  FillEntryPoints(field.frame.height_m, bundle.end, bundle.chunk);
  const ElevationPyramid& pyramid = field.pyramid;
  bundle.slab = lowered(pyramid, bundle.chunk, 0, bundle.end, {pyramid.lowest(), pyramid.highest()});
  fetch_terrain(terrain, bundle.chunk, bundle.end, bundle.slab);
}

void WalkBundle(const Heightfield& field, const WalkTerrain& terrain, Bundle& bundle,
                std::span<double> ranges) {
  RayChunk& chunk = bundle.chunk;
  const std::size_t lanes = hn::Lanes(D());
  const std::size_t group = kWalks * lanes;
  for (std::size_t begin = 0; begin < bundle.end; begin += group) {
    const HeightSlab under = lowered(field.pyramid, chunk, begin, begin + group, bundle.slab);
    const double path = path_cells(chunk, under);
    const LaneWalk::Start start = path < kPathInCell_cells ? LaneWalk::Start::in_cell
                                  : path < 2               ? LaneWalk::Start::among_cells
                                                           : LaneWalk::Start::among_blocks;
    LaneWalk walks[kWalks];
    for (std::size_t i = 0; i < kWalks; ++i) walks[i].enter(terrain, chunk, begin + i * lanes, under, start);
    WalkTogether(terrain, walks, start != LaneWalk::Start::in_cell);
    for (std::size_t i = 0; i < kWalks; ++i)
      hn::Store(walks[i].ranges(), D(), chunk.range + begin + i * lanes);
  }
  std::copy_n(chunk.range, ranges.size(), ranges.begin());
}

/// Prepares each bundle before the previous one walks: its ground is fetched in the meantime.
void WalkBundles(const Heightfield& field, const WalkTerrain& terrain, std::span<const Ray> rays,
                 std::span<double> ranges) {
  Bundle bundles[2];
  const auto prepare = [&](std::size_t begin) {
    if (begin >= rays.size()) return;
    const std::size_t count = std::min(kChunkRays, rays.size() - begin);
    Prepare(field, terrain, rays.subspan(begin, count), bundles[begin / kChunkRays % 2]);
  };
  prepare(0);
  for (std::size_t begin = 0; begin < rays.size(); begin += kChunkRays) {
    prepare(begin + kChunkRays);
    const std::size_t count = std::min(kChunkRays, rays.size() - begin);
    WalkBundle(field, terrain, bundles[begin / kChunkRays % 2], ranges.subspan(begin, count));
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(WalkBundles);

void walk_packets(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges) {
  assert(rays.size() == ranges.size());
  if (2 * field.pyramid.highs().size() >= std::size_t{1} << 31U) {
    std::fill(ranges.begin(), ranges.end(), kUndecided);
    return;
  }
  HWY_DYNAMIC_DISPATCH(WalkBundles)(field, WalkTerrain(field), rays, ranges);
}

}  // namespace landfall
#endif
