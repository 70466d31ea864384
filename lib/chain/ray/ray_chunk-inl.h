// SPDX-License-Identifier: GPL-3.0-or-later
// Converts a bundle of rays to a RayChunk, finds where its walk begins and what it will read. Compiled once
// for each instruction set (Highway).

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "chain/ray/walk_data.h"

#if defined(LANDFALL_RAY_RAY_CHUNK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_RAY_RAY_CHUNK_INL_H_
#undef LANDFALL_RAY_RAY_CHUNK_INL_H_
#else
#define LANDFALL_RAY_RAY_CHUNK_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "chain/ray/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// The first `end` rays of the chunk in whole vectors; the last ray of `rays` pads them.
void FillChunk(const GridFrame& frame, std::span<const Ray> rays, std::size_t end, RayChunk& chunk) {
  for (std::size_t i = 0; i < end; ++i) {
    const Ray& ray = rays[std::min(i, rays.size() - 1)];
    chunk.x[i] = ray.origin.v.x();
    chunk.y[i] = ray.origin.v.y();
    chunk.z[i] = ray.origin.v.z();
    chunk.dx[i] = ray.direction.v.x();
    chunk.dy[i] = ray.direction.v.y();
    chunk.dz[i] = ray.direction.v.z();
  }
  const D d;
  const V scale = constant(frame.cells_per_m);
  const V rounding = constant(GridRay::kRounding);
  for (std::size_t i = 0; i < end; i += hn::Lanes(d)) {
    const V x_cells = hn::Mul(load(chunk.x + i), scale);
    const V y_cells = hn::Mul(load(chunk.y + i), scale);
    const V reach = hn::Add(hn::Add(hn::Abs(x_cells), hn::Abs(y_cells)), constant(frame.extent_cells));
    const V height = hn::Add(hn::Abs(load(chunk.z + i)), constant(frame.height_m));
    const V anchor = constant(frame.anchor);
    hn::Store(hn::Sub(hn::Add(x_cells, anchor), constant(frame.anchor + frame.first_col)), d, chunk.x + i);
    hn::Store(hn::Sub(hn::Add(y_cells, anchor), constant(frame.anchor + frame.first_row)), d, chunk.y + i);
    hn::Store(hn::Mul(load(chunk.dx + i), scale), d, chunk.dx + i);
    hn::Store(hn::Mul(load(chunk.dy + i), scale), d, chunk.dy + i);
    hn::Store(hn::Mul(rounding, reach), d, chunk.position_error + i);
    hn::Store(hn::Mul(rounding, height), d, chunk.height_error + i);
  }
}

/// For the downward rays among the first `end`: their horizontal position as a linear function of elevation.
void FillEntryPoints(double height_m, std::size_t end, RayChunk& chunk) {
  const D d;
  const V nan = constant(std::numeric_limits<double>::quiet_NaN());
  V greatest = constant(0);
  for (std::size_t i = 0; i < end; i += hn::Lanes(d)) {
    const V z = load(chunk.z + i);
    const V climb = hn::Div(constant(1), load(chunk.dz + i));
    const V slope_x = hn::Mul(load(chunk.dx + i), climb);
    const V slope_y = hn::Mul(load(chunk.dy + i), climb);
    const V foot_x = hn::Sub(load(chunk.x + i), hn::Mul(slope_x, z));
    const V foot_y = hn::Sub(load(chunk.y + i), hn::Mul(slope_y, z));
    const V slope = hn::Add(hn::Abs(slope_x), hn::Abs(slope_y));
    // Sums below 1e11 keep the rounding of a position far below the margin of ElevationPyramid::over.
    const V reach = hn::Mul(slope, hn::Add(hn::Abs(z), constant(height_m)));
    const V size = hn::Add(reach, hn::Add(hn::Abs(load(chunk.x + i)), hn::Abs(load(chunk.y + i))));
    const M down = hn::And(hn::Lt(climb, constant(0)), hn::Lt(size, constant(1e11)));
    greatest = hn::IfThenElse(down, hn::Max(greatest, slope), greatest);
    hn::Store(hn::IfThenElse(down, foot_x, nan), d, chunk.foot_x + i);
    hn::Store(climb, d, chunk.climb + i);
    hn::Store(foot_y, d, chunk.foot_y + i);
    hn::Store(slope_x, d, chunk.slope_x + i);
    hn::Store(slope_y, d, chunk.slope_y + i);
  }
  chunk.greatest_slope = hn::GetLane(hn::MaxOfLanes(d, greatest));
}

/// The rectangle that the downward rays of a group cross between two elevations; empty without such a ray.
class CrossedBox {
 public:
  HWY_INLINE CrossedBox()
      : low_x_(constant(std::numeric_limits<double>::infinity())),
        high_x_(hn::Neg(low_x_)),
        low_y_(low_x_),
        high_y_(high_x_) {}

  HWY_INLINE void add(const RayChunk& chunk, std::size_t i, const HeightSlab& slab) {
    const V foot_x = load(chunk.foot_x + i);
    const M down = hn::Eq(foot_x, foot_x);
    for (const double elevation : {slab.low, slab.high}) {
      extend(down, hn::Add(foot_x, hn::Mul(load(chunk.slope_x + i), constant(elevation))), low_x_, high_x_);
      extend(down, hn::Add(load(chunk.foot_y + i), hn::Mul(load(chunk.slope_y + i), constant(elevation))),
             low_y_, high_y_);
    }
  }
  [[nodiscard]] HWY_INLINE CellBox box() const {
    const D d;
    return {hn::GetLane(hn::MinOfLanes(d, low_x_)), hn::GetLane(hn::MaxOfLanes(d, high_x_)),
            hn::GetLane(hn::MinOfLanes(d, low_y_)), hn::GetLane(hn::MaxOfLanes(d, high_y_))};
  }

 private:
  static HWY_INLINE void extend(M down, V position, V& low, V& high) {
    low = hn::IfThenElse(down, hn::Min(low, position), low);
    high = hn::IfThenElse(down, hn::Max(high, position), high);
  }

  V low_x_, high_x_, low_y_, high_y_;
};

/// The most cells that a downward ray of the chunk crosses between two elevations.
HWY_INLINE double path_cells(const RayChunk& chunk, const HeightSlab& slab) {
  return (slab.high - slab.low) * chunk.greatest_slope;
}

/// Shorter ways begin with a look into the cell where the ray starts.
constexpr double kPathInCell_cells = 0.5;

/// Lowers the slab to the surface under rays [begin, end) of the chunk, as long as that saves time.
HWY_INLINE HeightSlab lowered(const ElevationPyramid& pyramid, const RayChunk& chunk, std::size_t begin,
                              std::size_t end, HeightSlab slab) {
  constexpr double kShortPath_cells = 1;
  double thickness = std::numeric_limits<double>::infinity();
  while (slab.high - slab.low < 0.7 * thickness) {
    thickness = slab.high - slab.low;
    if (path_cells(chunk, slab) < kShortPath_cells) break;
    CrossedBox crossed;
    for (std::size_t i = begin; i < end; i += hn::Lanes(D())) crossed.add(chunk, i, slab);
    const ElevationPyramid::Bounds bounds = pyramid.over(crossed.box());
    // The space between the old and the new `high` lies inside the box, so the rays meet nothing there.
    slab.high = std::min(slab.high, std::max(double{bounds.high}, slab.low));
    slab.low = std::max(slab.low, std::min(double{bounds.low}, slab.high));
  }
  return slab;
}

/// Prefetches one row of values [first, last].
template <class T>
HWY_INLINE void fetch(const T* row, std::int64_t first, std::int64_t last) {
  constexpr auto kLine = static_cast<std::int64_t>(64 / sizeof(T));
  for (std::int64_t i = first; i < last; i += kLine) hwy::Prefetch(row + i);
  hwy::Prefetch(row + last);
}

/// Prefetches the nodes that the first `end` rays of the chunk may meet, and the bounds of their cells where
/// the paths are long enough to test these. This affects speed only: most pulses reach terrain that the
/// cache does not hold.
HWY_INLINE void fetch_terrain(const WalkTerrain& terrain, const RayChunk& chunk, std::size_t end,
                              const HeightSlab& slab) {
  constexpr double kMaxCells = 8192;  // 64 kB of nodes, so that they stay cached until they are used
  CrossedBox crossed;
  for (std::size_t i = 0; i < end; i += hn::Lanes(D())) crossed.add(chunk, i, slab);
  const CellBox box = crossed.box();
  const double low_x = std::max(box.low_x, 0.0);
  const double low_y = std::max(box.low_y, 0.0);
  const double high_x = std::min(box.high_x + 1, terrain.cols);
  const double high_y = std::min(box.high_y + 1, terrain.rows);
  const bool some = low_x <= high_x && low_y <= high_y;
  if (!some || !((high_x - low_x + 1) * (high_y - low_y + 1) < kMaxCells)) return;
  const auto west = static_cast<std::int64_t>(low_x);
  const auto east = static_cast<std::int64_t>(high_x);
  const auto north = static_cast<std::int64_t>(high_y);
  const auto cell_cols = terrain.node_cols - 1;
  const bool bounds = path_cells(chunk, slab) >= kPathInCell_cells;
  for (auto row = static_cast<std::int64_t>(low_y); row <= north; ++row) {
    fetch(terrain.nodes + row * terrain.node_cols, west, east);
    if (bounds) fetch(terrain.highs + row * cell_cols, west, east);
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
