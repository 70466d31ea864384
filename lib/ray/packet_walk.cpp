// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/packet_walk.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

// Vectors without a size at compile time cannot be members.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ray/packet_walk.cpp"
#include <hwy/foreach_target.h>  // this file again, once for each instruction set
#include <hwy/highway.h>

#ifndef LANDFALL_RAY_PACKET_WALK_ONCE
#define LANDFALL_RAY_PACKET_WALK_ONCE
namespace landfall {

/// Rays that are prepared together.
inline constexpr std::size_t kChunkRays = 64;

/// GridRays component by component; the last one fills up the rest. A ray that goes down passes
/// (foot + slope * elevation) in the horizontal; foot_x is NaN in others.
struct RayChunk {
  alignas(64) double x[kChunkRays], y[kChunkRays], z[kChunkRays];
  alignas(64) double dx[kChunkRays], dy[kChunkRays], dz[kChunkRays];
  alignas(64) double position_error[kChunkRays], height_error[kChunkRays];
  alignas(64) double foot_x[kChunkRays], foot_y[kChunkRays];
  alignas(64) double slope_x[kChunkRays], slope_y[kChunkRays];
  alignas(64) double range[kChunkRays];
  double greatest_slope;  ///< cells per metre, of the rays that go down
};

/// Elevations between which rays are looked at. That no ray of the group meets the surface above `high` is
/// certain; `low` is a guess that holes may belie.
struct HeightSlab {
  double low;
  double high;
};

}  // namespace landfall
#endif

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE V constant(double value) { return hn::Set(D(), value); }
HWY_INLINE V load(const double* values) { return hn::Load(D(), values); }
HWY_INLINE bool any(M mask) { return !hn::AllFalse(D(), mask); }
HWY_INLINE bool all(M mask) { return hn::AllTrue(D(), mask); }

/// GridRay in lanes, by the same operations.
struct LaneRays {
  V x, y, z, dx, dy, dz, position_error, height_error, horizontal_speed;

  HWY_INLINE LaneRays(const RayChunk& chunk, std::size_t i)
      : x(load(chunk.x + i)),
        y(load(chunk.y + i)),
        z(load(chunk.z + i)),
        dx(load(chunk.dx + i)),
        dy(load(chunk.dy + i)),
        dz(load(chunk.dz + i)),
        position_error(load(chunk.position_error + i)),
        height_error(load(chunk.height_error + i)),
        horizontal_speed(hn::Add(hn::Abs(dx), hn::Abs(dy))) {}
};

void FillChunk(const GridFrame& frame, std::span<const Ray> rays, RayChunk& chunk) {
  for (std::size_t i = 0; i < kChunkRays; ++i) {
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
  for (std::size_t i = 0; i < kChunkRays; i += hn::Lanes(d)) {
    const V x_cells = hn::Mul(load(chunk.x + i), scale);
    const V y_cells = hn::Mul(load(chunk.y + i), scale);
    const V reach = hn::Add(hn::Add(hn::Abs(x_cells), hn::Abs(y_cells)), constant(frame.extent_cells));
    const V height = hn::Add(hn::Abs(load(chunk.z + i)), constant(frame.height_m));
    hn::Store(hn::Sub(x_cells, constant(frame.first_col)), d, chunk.x + i);
    hn::Store(hn::Sub(y_cells, constant(frame.first_row)), d, chunk.y + i);
    hn::Store(hn::Mul(load(chunk.dx + i), scale), d, chunk.dx + i);
    hn::Store(hn::Mul(load(chunk.dy + i), scale), d, chunk.dy + i);
    hn::Store(hn::Mul(rounding, reach), d, chunk.position_error + i);
    hn::Store(hn::Mul(rounding, height), d, chunk.height_error + i);
  }
}

/// Where the rays that go down pass elevation after elevation.
void FillFeet(double height_m, RayChunk& chunk) {
  const D d;
  const V nan = constant(std::numeric_limits<double>::quiet_NaN());
  V greatest = constant(0);
  for (std::size_t i = 0; i < kChunkRays; i += hn::Lanes(d)) {
    const V z = load(chunk.z + i);
    const V climb = hn::Div(constant(1), load(chunk.dz + i));
    const V slope_x = hn::Mul(load(chunk.dx + i), climb);
    const V slope_y = hn::Mul(load(chunk.dy + i), climb);
    const V foot_x = hn::Sub(load(chunk.x + i), hn::Mul(slope_x, z));
    const V foot_y = hn::Sub(load(chunk.y + i), hn::Mul(slope_y, z));
    const V slope = hn::Add(hn::Abs(slope_x), hn::Abs(slope_y));
    // Sums below 1e11 keep the rounding of a place far below the margin of ElevationPyramid::over.
    const V reach = hn::Mul(slope, hn::Add(hn::Abs(z), constant(height_m)));
    const V size = hn::Add(reach, hn::Add(hn::Abs(load(chunk.x + i)), hn::Abs(load(chunk.y + i))));
    const M down = hn::And(hn::Lt(climb, constant(0)), hn::Lt(size, constant(1e11)));
    greatest = hn::IfThenElse(down, hn::Max(greatest, slope), greatest);
    hn::Store(hn::IfThenElse(down, foot_x, nan), d, chunk.foot_x + i);
    hn::Store(foot_y, d, chunk.foot_y + i);
    hn::Store(slope_x, d, chunk.slope_x + i);
    hn::Store(slope_y, d, chunk.slope_y + i);
  }
  chunk.greatest_slope = hn::GetLane(hn::MaxOfLanes(d, greatest));
}

/// The rectangle that the downward rays of a group cross between two elevations; empty where none goes down.
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

/// Lowers the slab to the surface under rays [begin, end) of the chunk, as long as that pays.
HWY_INLINE HeightSlab lowered(const ElevationPyramid& pyramid, const RayChunk& chunk, std::size_t begin,
                              std::size_t end, HeightSlab slab) {
  constexpr double kShortWay_cells = 1;
  double thickness = std::numeric_limits<double>::infinity();
  while (slab.high - slab.low < 0.7 * thickness) {
    thickness = slab.high - slab.low;
    if (thickness * chunk.greatest_slope < kShortWay_cells) break;
    CrossedBox crossed;
    for (std::size_t i = begin; i < end; i += hn::Lanes(D())) crossed.add(chunk, i, slab);
    const ElevationPyramid::Bounds bounds = pyramid.over(crossed.box());
    // What lies between the old and the new `high` is inside the box, so the rays meet nothing there.
    slab.high = std::min(slab.high, std::max(double{bounds.high}, slab.low));
    slab.low = std::max(slab.low, std::min(double{bounds.low}, slab.high));
  }
  return slab;
}

/// CornerTriangle in lanes.
struct LaneTriangle {
  V corner, along_x, along_y, x, y, dx, dy;
};

/// certain_range in lanes, by the same operations.
HWY_INLINE V CertainRange(const LaneRays& ray, const LaneTriangle& t) {
  const V slope_x = hn::Sub(t.along_x, t.corner);
  const V slope_y = hn::Sub(t.along_y, t.corner);
  const V steepness = hn::Add(hn::Abs(slope_x), hn::Abs(slope_y));
  const V descent = hn::Sub(hn::Sub(ray.dz, hn::Mul(slope_x, t.dx)), hn::Mul(slope_y, t.dy));
  const V per_descent = hn::Div(constant(1), descent);
  const V rise = hn::Add(hn::Add(hn::Sub(t.corner, ray.z), hn::Mul(slope_x, t.x)), hn::Mul(slope_y, t.y));
  const V range = hn::Mul(rise, per_descent);
  const V range_error =
      hn::Mul(hn::Add(ray.height_error, hn::Mul(steepness, ray.position_error)), hn::Abs(per_descent));
  const V margin = hn::Add(ray.position_error, hn::Mul(ray.horizontal_speed, range_error));
  const V u = hn::Add(t.x, hn::Mul(t.dx, range));
  const V v = hn::Add(t.y, hn::Mul(t.dy, range));
  const V w = hn::Sub(hn::Sub(constant(1), u), v);
  const V outside = hn::Neg(margin);
  // Not by Ne, which says false of NaN on some instruction sets.
  const M hole = hn::Not(hn::Eq(hn::Sub(steepness, steepness), constant(0)));
  const M beside = hn::Or(hn::Or(hn::Lt(u, outside), hn::Lt(v, outside)), hn::Lt(w, outside));
  const M miss = hn::Or(hole, hn::Or(beside, hn::Lt(range, hn::Neg(range_error))));
  const M inside = hn::And(hn::And(hn::Gt(u, margin), hn::Gt(v, margin)), hn::Gt(w, margin));
  const M sharp = hn::And(hn::Gt(range, range_error), hn::Lt(range_error, constant(GridRay::kSharp_m)));
  const V decided =
      hn::IfThenElse(hn::And(inside, sharp), range, constant(std::numeric_limits<double>::quiet_NaN()));
  return hn::IfThenElse(miss, constant(std::numeric_limits<double>::infinity()), decided);
}

/// The walk of one vector of rays, all on one level: cells on level 0, the pyramid's blocks above.
class Walk {
 public:
  HWY_INLINE Walk(const Heightfield& field, const RayChunk& chunk, std::size_t begin, const HeightSlab& slab)
      : field_(field), rays_(chunk, begin) {
    const V foot_x = load(chunk.foot_x + begin);
    enter(slab, hn::Eq(foot_x, foot_x));
  }

  /// Distances, NaN for a miss, kUndecided.
  HWY_INLINE V ranges() {
    int level = 0;
    for (int visit = 0; visit < kMostVisits && any(active_); ++visit)
      level = level == 0 ? visit_cells() : visit_blocks(level);
    return range_;
  }

 private:
  /// Skipping keeps this distance from the surface, in metres, and crossing times must be surer than it.
  static constexpr double kSlack_m = 1e-6;
  /// Of blocks and cells, until the lanes that still walk are left to Descent: it crosses wide country
  /// faster, and country above the ray much faster. A rough surface seen at 45 degrees takes some 17 visits.
  static constexpr int kMostVisits = 64;

  /// `sure`: the rays that go down; the slab holds for no others.
  HWY_INLINE void enter(const HeightSlab& slab, M sure) {
    const GridSpec& spec = field_.spec();
    const V one = constant(1);
    const V climb = hn::Div(one, rays_.dz);
    const V end_z = constant(double{field_.pyramid.lowest()} - kSlack_m);
    end_ = hn::Mul(hn::Sub(end_z, rays_.z), climb);
    const V start_z = constant(slab.high + kSlack_m);
    const V start = hn::Max(constant(0), hn::Mul(hn::Sub(start_z, rays_.z), climb));
    last_col_ = constant(static_cast<double>(spec.cols - 2));
    last_row_ = constant(static_cast<double>(spec.rows - 2));
    margin_ = hn::Add(rays_.position_error,
                      hn::Mul(rays_.horizontal_speed, hn::Abs(hn::Mul(rays_.height_error, climb))));
    sure = hn::And(sure, hn::Lt(rays_.height_error, constant(kSlack_m / 4)));
    sure = hn::And(sure, place(rays_.x, rays_.dx, start, col_));
    sure = hn::And(sure, place(rays_.y, rays_.dy, start, row_));
    sure = hn::And(sure, in_grid());
    const V error_x = pace(rays_.x, rays_.dx, col_, per_dx_, sure);
    const V error_y = pace(rays_.y, rays_.dy, row_, per_dy_, sure);
    margin_ = hn::Add(margin_, hn::Mul(rays_.horizontal_speed, hn::Add(error_x, error_y)));
    ahead_x_ = hn::IfThenElseZero(hn::Gt(rays_.dx, constant(0)), one);
    ahead_y_ = hn::IfThenElseZero(hn::Gt(rays_.dy, constant(0)), one);
    active_ = sure;
    range_ = constant(kUndecided);
  }

  /// Which cell a coordinate lies in after `range`, and whether that is certain.
  HWY_INLINE M place(V origin, V speed, V range, V& cell) const {
    const V position = hn::Add(origin, hn::Mul(speed, range));
    cell = hn::Floor(position);
    const V inside = hn::Sub(position, cell);
    return hn::And(hn::Gt(inside, margin_), hn::Gt(hn::Sub(constant(1), inside), margin_));
  }

  /// Metres per cell along one axis, and the error of the ranges at which the ray crosses cell borders. A
  /// ray too steep to tell these must stay in its cell down to the lowest elevation: it never crosses.
  HWY_INLINE V pace(V origin, V speed, V cell, V& per_speed, M& sure) const {
    const V metres = hn::Div(constant(1), speed);
    const V error = hn::Mul(hn::Abs(metres), rays_.position_error);
    const M steep = hn::Not(hn::Lt(error, constant(kSlack_m / 8)));
    V end_cell;
    const M placed = place(origin, speed, end_, end_cell);
    const M stays = hn::And(placed, hn::Eq(end_cell, cell));
    sure = hn::And(sure, hn::Or(hn::Not(steep), stays));
    per_speed = hn::IfThenElse(steep, constant(std::numeric_limits<double>::quiet_NaN()), metres);
    return hn::IfThenElse(steep, constant(0), error);
  }

  [[nodiscard]] HWY_INLINE M in_grid() const {
    const V zero = constant(0);
    return hn::And(hn::And(hn::Ge(col_, zero), hn::Le(col_, last_col_)),
                   hn::And(hn::Ge(row_, zero), hn::Le(row_, last_row_)));
  }

  /// A square of cells on the grid of such squares, and where the ray leaves it.
  struct Square {
    double size;
    V col, row;  ///< counted in squares
    V leave_x, leave_y;
    V leave;
  };

  HWY_INLINE Square square(double size) const {
    const V per_size = constant(1 / size);
    const V infinity = constant(std::numeric_limits<double>::infinity());
    Square s{
        size,    hn::Floor(hn::Mul(col_, per_size)), hn::Floor(hn::Mul(row_, per_size)), infinity, infinity,
        infinity};
    const V border_x = hn::Mul(hn::Add(s.col, ahead_x_), constant(size));
    const V border_y = hn::Mul(hn::Add(s.row, ahead_y_), constant(size));
    const V leave_x = hn::Mul(hn::Sub(border_x, rays_.x), per_dx_);
    const V leave_y = hn::Mul(hn::Sub(border_y, rays_.y), per_dy_);
    s.leave_x = hn::IfThenElse(hn::Eq(leave_x, leave_x), leave_x, infinity);
    s.leave_y = hn::IfThenElse(hn::Eq(leave_y, leave_y), leave_y, infinity);
    s.leave = hn::Min(s.leave_x, s.leave_y);
    return s;
  }

  HWY_INLINE int visit_blocks(int level) {
    const ElevationPyramid::Level& blocks = field_.pyramid.level(level - 1);
    const Square s = square(static_cast<double>(ElevationPyramid::kBlockCells << (level - 1)));
    const hn::Rebind<std::int32_t, D> d32;
    const hn::Rebind<float, D> df;
    const V index = hn::Add(hn::Mul(s.row, constant(static_cast<double>(blocks.cols))), s.col);
    const auto index32 = hn::DemoteTo(d32, hn::IfThenElseZero(active_, index));
    const V high = hn::PromoteTo(D(), hn::GatherIndex(df, blocks.high.data(), index32));
    const V leave_z = hn::Add(rays_.z, hn::Mul(rays_.dz, s.leave));
    const M above = hn::And(active_, hn::Gt(hn::Sub(leave_z, high), constant(4 * kSlack_m)));
    const M below = hn::AndNot(above, active_);
    advance(above, s);
    if (any(below)) return level - 1;
    return std::min(level + 1, field_.pyramid.level_count());
  }

  HWY_INLINE int visit_cells() {
    const Square s = square(1);
    const Cell cell = cell_under();
    // False where a node is a hole: the cell's other triangle may be whole.
    const V low_z = hn::Sub(hn::Add(rays_.z, hn::Mul(rays_.dz, s.leave)), constant(4 * kSlack_m));
    const M above = hn::And(hn::And(hn::Gt(low_z, cell.south_west), hn::Gt(low_z, cell.south_east)),
                            hn::And(hn::Gt(low_z, cell.north_west), hn::Gt(low_z, cell.north_east)));
    if (any(hn::AndNot(above, active_))) {
      const V range = range_in(cell);
      const V infinity = constant(std::numeric_limits<double>::infinity());
      range_ = hn::IfThenElse(hn::And(active_, hn::Lt(range, infinity)), range, range_);
      active_ = hn::And(active_, hn::Eq(range, infinity));
      if (!any(active_)) return 0;
    }
    const V col = block_of(col_);
    const V row = block_of(row_);
    advance(active_, s);
    const M same = hn::And(hn::Eq(col, block_of(col_)), hn::Eq(row, block_of(row_)));
    return any(hn::AndNot(same, active_)) ? 1 : 0;
  }

  static HWY_INLINE V block_of(V cell) {
    return hn::Floor(hn::Mul(cell, constant(1.0 / static_cast<double>(ElevationPyramid::kBlockCells))));
  }

  /// Elevations of the nodes around the lanes' cells.
  struct Cell {
    V south_west, south_east, north_west, north_east;
  };

  HWY_INLINE Cell cell_under() const {
    const D d;
    const hn::Rebind<std::int32_t, D> d32;
    const hn::Rebind<std::int64_t, D> d64;
    const std::int64_t cols = field_.spec().cols;
    const V index = hn::Add(hn::Mul(row_, constant(static_cast<double>(cols))), col_);
    const auto node = hn::PromoteTo(d64, hn::DemoteTo(d32, hn::IfThenElseZero(active_, index)));
    const double* const nodes = field_.terrain.nodes().values().data();
    return {hn::GatherIndex(d, nodes, node), hn::GatherIndex(d, nodes + 1, node),
            hn::GatherIndex(d, nodes + cols, node), hn::GatherIndex(d, nodes + cols + 1, node)};
  }

  /// Distance in the lanes' cells; infinite for a miss, NaN where it is not certain.
  HWY_INLINE V range_in(const Cell& cell) const {
    const V x = hn::Sub(rays_.x, col_);
    const V y = hn::Sub(rays_.y, row_);
    const V one = constant(1);
    const V lower =
        CertainRange(rays_, {cell.south_west, cell.south_east, cell.north_west, x, y, rays_.dx, rays_.dy});
    const V upper = CertainRange(rays_, {cell.north_east, cell.north_west, cell.south_east, hn::Sub(one, x),
                                         hn::Sub(one, y), hn::Neg(rays_.dx), hn::Neg(rays_.dy)});
    // Minima of NaN differ between instruction sets: choose by comparison, and let any NaN through.
    const V nearer = hn::IfThenElse(hn::Lt(lower, upper), lower, upper);
    return hn::IfThenElse(hn::Eq(lower, lower), nearer, lower);
  }

  /// Takes lanes to the cell where they leave their square; those that fall below the lowest elevation or off
  /// the grid have missed.
  HWY_INLINE void advance(M lanes, const Square& s) {
    const V one = constant(1);
    const V size = constant(s.size);
    const M by_x = hn::Lt(s.leave_x, s.leave_y);
    V col;
    V row;
    const M col_sure = place(rays_.x, rays_.dx, s.leave, col);
    const M row_sure = place(rays_.y, rays_.dy, s.leave, row);
    const V next_col = hn::Sub(hn::Mul(hn::Add(s.col, ahead_x_), size), hn::Sub(one, ahead_x_));
    const V next_row = hn::Sub(hn::Mul(hn::Add(s.row, ahead_y_), size), hn::Sub(one, ahead_y_));
    col = hn::IfThenElse(by_x, next_col, col);
    row = hn::IfThenElse(by_x, row, next_row);
    const M sure = hn::Or(hn::And(by_x, row_sure), hn::AndNot(by_x, col_sure));
    col_ = hn::IfThenElse(lanes, col, col_);
    row_ = hn::IfThenElse(lanes, row, row_);
    const M under = hn::And(lanes, hn::Gt(s.leave, end_));
    const M unsure = hn::AndNot(hn::Or(sure, under), lanes);
    const M off = hn::And(hn::And(lanes, sure), hn::Not(in_grid()));
    const M missed = hn::Or(under, off);
    range_ = hn::IfThenElse(missed, constant(std::numeric_limits<double>::quiet_NaN()), range_);
    active_ = hn::AndNot(hn::Or(missed, unsure), active_);
  }

  const Heightfield& field_;
  LaneRays rays_;
  V per_dx_, per_dy_;      ///< metres per cell; NaN where the ray stays in its column or row
  V ahead_x_, ahead_y_;    ///< 1 towards greater cells, else 0
  V last_col_, last_row_;  ///< cells
  V end_;                  ///< range at which the lowest elevation has been passed
  V margin_;               ///< error of a position, cells
  V col_, row_;            ///< the cell, whole numbers
  V range_;
  M active_;
};

void WalkChunk(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges) {
  RayChunk chunk;
  FillChunk(field.frame, rays, chunk);
  FillFeet(field.frame.height_m, chunk);
  const std::size_t lanes = hn::Lanes(D());
  const std::size_t end = (rays.size() + lanes - 1) / lanes * lanes;
  const ElevationPyramid& pyramid = field.pyramid;
  const HeightSlab slab = lowered(pyramid, chunk, 0, end, {pyramid.lowest(), pyramid.highest()});
  for (std::size_t i = 0; i < end; i += lanes) {
    Walk walk(field, chunk, i, lowered(pyramid, chunk, i, i + lanes, slab));
    hn::Store(walk.ranges(), D(), chunk.range + i);
  }
  std::copy_n(chunk.range, rays.size(), ranges.begin());
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(WalkChunk);

void walk_packets(const Heightfield& field, std::span<const Ray> rays, std::span<double> ranges) {
  assert(rays.size() == ranges.size());
  if (field.spec().size() >= std::size_t{1} << 31U) {
    std::fill(ranges.begin(), ranges.end(), kUndecided);
    return;
  }
  for (std::size_t begin = 0; begin < rays.size(); begin += kChunkRays) {
    const std::size_t count = std::min(kChunkRays, rays.size() - begin);
    HWY_DYNAMIC_DISPATCH(WalkChunk)(field, rays.subspan(begin, count), ranges.subspan(begin, count));
  }
}

}  // namespace landfall
#endif
