// SPDX-License-Identifier: GPL-3.0-or-later
// The walk of rays over the grid in SIMD lanes. Compiled once for each instruction set (Highway).

#include <algorithm>
#include <limits>

#include "chain/ray/packet_walk.h"
#include "chain/ray/walk_data.h"

#if defined(LANDFALL_RAY_LANE_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_RAY_LANE_WALK_INL_H_
#undef LANDFALL_RAY_LANE_WALK_INL_H_
#else
#define LANDFALL_RAY_LANE_WALK_INL_H_
#endif

#include <hwy/highway.h>

#include "chain/ray/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Walks one vector of rays over the grid from block to block, each lane on its own level. The walk
/// alternates between two parts: step() until every lane is done or has reached a cell that its ray may meet,
/// then find_range() in these cells. Both are free of branches, so that the steps of several walks overlap.
/// Rays may have any origin and any direction. Where rounding might decide, the result is kUndecided.
class LaneWalk {
 public:
  enum class Start { in_cell, among_cells, among_blocks };

  HWY_INLINE void enter(const WalkTerrain& terrain, const RayChunk& chunk, std::size_t begin,
                        const HeightSlab& slab, Start start);
  /// Moves each searching lane one block on, or one level down. Returns whether any lane is still searching.
  HWY_INLINE bool step(const WalkTerrain& terrain);
  /// Tests the cells that the lanes have reached. Returns whether any lane must continue.
  HWY_INLINE bool find_range(const WalkTerrain& terrain);
  /// Distances; NaN for a miss, kUndecided where rounding might decide.
  [[nodiscard]] HWY_INLINE V ranges() const { return hn::IfThenElse(missed_, nan(), range_); }

 private:
  using Index = hn::RebindToSigned<D>;
  using VI = hn::Vec<Index>;

  /// Skipped space keeps this distance from the surface, in metres; crossing times must err by less.
  static constexpr double kSlack_m = 1e-6;
  /// A ray with a larger 1 / dz counts as level: it is not clipped to elevations.
  static constexpr double kLevel = 1e9;

  static HWY_INLINE V infinity() { return constant(std::numeric_limits<double>::infinity()); }
  static HWY_INLINE V nan() { return constant(std::numeric_limits<double>::quiet_NaN()); }

  /// The ray along one horizontal axis: `origin + speed * range`. It crosses b at `b * per_speed + offset`. A
  /// ray too steep to compute its crossings stays in its column (row) and crosses at infinity.
  struct Axis {
    V per_speed, offset;
    V ahead;   ///< 1 towards increasing cells, else 0
    V behind;  ///< 1 - ahead
    V error;   ///< of the ranges at which the ray crosses borders, metres
    V leaves;  ///< range at which the ray leaves the grid's width
    M steep;
  };
  HWY_INLINE Axis axis(V origin, V speed, double width) const;

  /// The place of a ray along one axis: its cell, and whether that is certain.
  struct CellPosition {
    V position, cell;
    M sure;
  };
  HWY_INLINE CellPosition position(V origin, V speed, V range) const {
    const V position = hn::MulAdd(speed, range, origin);
    const V cell = hn::Floor(position);
    const V off_middle = hn::Abs(hn::Sub(hn::Sub(position, cell), constant(0.5)));
    return {position, cell, hn::Lt(off_middle, middle_)};
  }
  static HWY_INLINE M off(V position, double low, double high) {
    return hn::Or(hn::Lt(position, constant(low)), hn::Gt(position, constant(high)));
  }
  static HWY_INLINE M in_grid(const WalkTerrain& terrain, const CellPosition& col, const CellPosition& row) {
    return hn::Not(hn::Or(off(col.cell, 0, terrain.cols - 1), off(row.cell, 0, terrain.rows - 1)));
  }
  /// Range at which a ray enters the grid's width, -infinity where steep.
  static HWY_INLINE V entrance(const Axis& along, double width);
  static HWY_INLINE void put_on_border(const Axis& along, M comes_over, double width, CellPosition& position);
  /// Moves rays that start outside the grid to where they enter it. Returns which of them certainly miss it.
  HWY_INLINE M position_at_entrance(const WalkTerrain& terrain, const Axis& x, const Axis& y,
                                    CellPosition& col, CellPosition& row);
  /// Whether a ray certainly ends in the cell where it starts.
  HWY_INLINE M stays(V origin, V speed, const CellPosition& start) const;
  /// Starts where a ray reaches the elevations of the surface, and ends where it has passed them.
  HWY_INLINE void cut_to_heights(const WalkTerrain& terrain, const RayChunk& chunk, std::size_t begin,
                                 const HeightSlab& slab);

  static HWY_INLINE V looked_up(const double* table, VI level) {
    const D d;
    if constexpr (hn::MaxLanes(d) == WalkTerrain::kMaxLevels)
      return hn::TableLookupLanes(hn::Load(d, table), hn::IndicesFromVec(d, level));
    else
      return hn::GatherIndex(d, table, level);
  }
  static HWY_INLINE VI index_of(V whole) {
    const hn::Rebind<std::int32_t, D> d32;
    return hn::PromoteTo(Index(), hn::DemoteTo(d32, whole));
  }

  HWY_INLINE V block_bound(const WalkTerrain& terrain, V row, V col) const;
  HWY_INLINE V range_in_cell(const WalkTerrain& terrain);

  LaneRays rays_;
  V per_dx_, per_dy_, offset_x_, offset_y_, ahead_x_, ahead_y_, behind_x_, behind_y_;  // the members of Axis
  V end_;     ///< range at which the ray has left the grid's width or the terrain's heights
  V middle_;  ///< half a cell less the error of a position: how far off the cell's middle it surely is inside
  V col_, row_;   ///< the cell, whole numbers
  V at_;          ///< range at which the ray enters the cell
  V side_;        ///< 1 where the ray is assumed above the surface, -1 below: a guess, for speed only
  V side_first_;  ///< where the bounds of that side begin
  M nears_;       ///< approaches the surface on that side
  VI level_;
  V range_;
  M missed_;
  M searching_;
  M passed_;   ///< has looked into its cell and found no hit
  M waiting_;  ///< must still look into its cell
};

HWY_INLINE LaneWalk::Axis LaneWalk::axis(V origin, V speed, double width) const {
  Axis a;
  const V metres = hn::Div(constant(1), speed);
  const V error = hn::Mul(hn::Abs(metres), rays_.position_error);
  a.steep = hn::Not(hn::Lt(error, constant(kSlack_m / 8)));
  a.error = hn::IfThenZeroElse(a.steep, error);
  a.per_speed = hn::IfThenZeroElse(a.steep, metres);
  a.offset = hn::IfThenElse(a.steep, infinity(), hn::Neg(hn::Mul(origin, metres)));
  a.ahead = hn::IfThenElseZero(hn::Gt(speed, constant(0)), constant(1));
  a.behind = hn::Sub(constant(1), a.ahead);
  a.leaves = hn::MulAdd(hn::Mul(a.ahead, constant(width)), a.per_speed, a.offset);
  return a;
}

HWY_INLINE V LaneWalk::entrance(const Axis& along, double width) {
  const V near = hn::Mul(along.behind, constant(width));
  return hn::IfThenElse(along.steep, hn::Neg(infinity()), hn::MulAdd(near, along.per_speed, along.offset));
}

HWY_INLINE void LaneWalk::put_on_border(const Axis& along, M comes_over, double width,
                                        CellPosition& position) {
  position.cell = hn::IfThenElse(comes_over, hn::Mul(along.behind, constant(width - 1)), position.cell);
  position.sure = hn::Or(position.sure, comes_over);
}

HWY_INLINE M LaneWalk::position_at_entrance(const WalkTerrain& terrain, const Axis& x, const Axis& y,
                                            CellPosition& col, CellPosition& row) {
  const V enters_x = entrance(x, terrain.cols);
  const V enters_y = entrance(y, terrain.rows);
  at_ = hn::Max(at_, hn::Max(enters_x, enters_y));
  col = position(rays_.x, rays_.dx, at_);
  row = position(rays_.y, rays_.dy, at_);
  const M off_x = hn::AndNot(x.steep, off(col.position, -1, terrain.cols + 1));
  const M off_y = hn::AndNot(y.steep, off(row.position, -1, terrain.rows + 1));
  const M over_x = hn::Eq(at_, enters_x);
  const M over_y = hn::Eq(at_, enters_y);
  put_on_border(x, over_x, terrain.cols, col);
  put_on_border(y, over_y, terrain.rows, row);
  const M corner = hn::And(over_x, over_y);
  col.sure = hn::AndNot(corner, col.sure);
  const M sure = hn::And(col.sure, row.sure);
  const M beside_x = hn::AndNot(x.steep, off(col.cell, 0, terrain.cols - 1));
  const M beside_y = hn::AndNot(y.steep, off(row.cell, 0, terrain.rows - 1));
  const M beside = hn::And(sure, hn::Or(hn::Or(beside_x, beside_y), hn::Gt(at_, end_)));
  return hn::Or(beside, hn::AndNot(corner, hn::Or(off_x, off_y)));
}

HWY_INLINE M LaneWalk::stays(V origin, V speed, const CellPosition& start) const {
  const CellPosition last = position(origin, speed, end_);
  return hn::And(last.sure, hn::Eq(last.cell, start.cell));
}

HWY_INLINE void LaneWalk::cut_to_heights(const WalkTerrain& terrain, const RayChunk& chunk, std::size_t begin,
                                         const HeightSlab& slab) {
  const V foot_x = load(chunk.foot_x + begin);
  const V climb = load(chunk.climb + begin);
  const M up = hn::Gt(climb, constant(0));
  const M slanting = hn::Lt(hn::Abs(climb), constant(kLevel));
  const V lowest = constant(terrain.lowest - kSlack_m);
  const V highest = constant(terrain.highest + kSlack_m);
  const V high = hn::IfThenElse(hn::Eq(foot_x, foot_x), constant(slab.high + kSlack_m), highest);
  const V start_z = hn::IfThenElse(up, lowest, high);
  const V end_z = hn::IfThenElse(up, highest, lowest);
  const V start = hn::IfThenElseZero(slanting, hn::Mul(hn::Sub(start_z, rays_.z), climb));
  at_ = hn::Max(constant(0), start);
  end_ = hn::IfThenElse(slanting, hn::Mul(hn::Sub(end_z, rays_.z), climb), infinity());
  nears_ = hn::Not(up);
}

HWY_INLINE void LaneWalk::enter(const WalkTerrain& terrain, const RayChunk& chunk, std::size_t begin,
                                const HeightSlab& slab, Start start) {
  rays_ = LaneRays(chunk, begin);
  const Axis x = axis(rays_.x, rays_.dx, terrain.cols);
  const Axis y = axis(rays_.y, rays_.dy, terrain.rows);
  const V margin = hn::Add(rays_.position_error, hn::Mul(rays_.horizontal_speed, hn::Add(x.error, y.error)));
  middle_ = hn::Sub(constant(0.5), margin);
  cut_to_heights(terrain, chunk, begin, slab);
  end_ = hn::Min(end_, hn::Min(x.leaves, y.leaves));

  CellPosition col = position(rays_.x, rays_.dx, at_);
  CellPosition row = position(rays_.y, rays_.dy, at_);
  const M known = hn::And(hn::Lt(rays_.height_error, constant(kSlack_m / 4)), hn::Gt(middle_, constant(0)));
  const M inside =
      hn::And(hn::And(col.sure, row.sure), hn::And(in_grid(terrain, col, row), hn::Lt(at_, end_)));
  const M none = hn::And(inside, hn::Not(inside));
  missed_ = none;
  if (!all(inside)) missed_ = hn::And(known, position_at_entrance(terrain, x, y, col, row));
  M sure = hn::And(hn::And(known, in_grid(terrain, col, row)), hn::And(col.sure, row.sure));
  // A ray that is too steep for its crossings to be computed must not cross any border.
  if (any(hn::Or(x.steep, y.steep))) {
    sure = hn::And(sure, hn::Or(hn::Not(x.steep), stays(rays_.x, rays_.dx, col)));
    sure = hn::And(sure, hn::Or(hn::Not(y.steep), stays(rays_.y, rays_.dy, row)));
  }
  const M active = hn::AndNot(missed_, sure);
  passed_ = none;
  searching_ = start == Start::in_cell ? none : active;
  waiting_ = start == Start::in_cell ? active : none;
  col_ = hn::IfThenElseZero(active, col.cell);
  row_ = hn::IfThenElseZero(active, row.cell);
  level_ = hn::Set(Index(), start == Start::among_blocks ? std::min(1, terrain.top_level) : 0);
  range_ = constant(kUndecided);
  side_ = constant(1);
  side_first_ = constant(0);
  per_dx_ = x.per_speed;
  per_dy_ = y.per_speed;
  offset_x_ = x.offset;
  offset_y_ = y.offset;
  ahead_x_ = x.ahead;
  ahead_y_ = y.ahead;
  behind_x_ = x.behind;
  behind_y_ = y.behind;
}

/// The elevation bound of the lanes' blocks on the side where the ray is.
HWY_INLINE V LaneWalk::block_bound(const WalkTerrain& terrain, V row, V col) const {
  const D d;
  const hn::Rebind<std::int32_t, D> d32;
  const hn::Rebind<float, D> half;
  const V first = hn::Add(looked_up(terrain.first, level_), side_first_);
  const V index = hn::Add(hn::MulAdd(row, looked_up(terrain.block_cols, level_), col), first);
  return hn::PromoteTo(d, hn::GatherIndex(half, terrain.highs, hn::DemoteTo(d32, index)));
}

HWY_INLINE bool LaneWalk::step(const WalkTerrain& terrain) {
  const V one = constant(1);
  const V size = looked_up(terrain.size, level_);
  const V per_size = looked_up(terrain.per_size, level_);
  const V block_col = hn::Floor(hn::Mul(col_, per_size));
  const V block_row = hn::Floor(hn::Mul(row_, per_size));
  const V border_col = hn::Add(block_col, ahead_x_);
  const V border_row = hn::Add(block_row, ahead_y_);
  const V border_x = hn::Mul(border_col, size);
  const V border_y = hn::Mul(border_row, size);
  const V leave_x = hn::MulAdd(border_x, per_dx_, offset_x_);
  const V leave_y = hn::MulAdd(border_y, per_dy_, offset_y_);
  const M by_x = hn::Lt(leave_x, leave_y);
  const V leave = hn::Min(leave_x, leave_y);

  const V nearest_z = hn::MulAdd(rays_.dz, hn::IfThenElse(nears_, leave, at_), rays_.z);
  const V distance = hn::Mul(side_, hn::Sub(nearest_z, block_bound(terrain, block_row, block_col)));
  const M clear = hn::Or(passed_, hn::Gt(distance, constant(4 * kSlack_m)));
  const M go = hn::And(searching_, clear);
  const M stop = hn::AndNot(clear, searching_);

  const V origin = hn::IfThenElse(by_x, rays_.y, rays_.x);
  const V speed = hn::IfThenElse(by_x, rays_.dy, rays_.dx);
  // Also where the ray ends: at a node of the grid's border it touches the next cell.
  const CellPosition other = position(origin, speed, hn::Min(leave, end_));
  const M sure = hn::And(go, other.sure);
  const M past = hn::Ge(leave, end_);
  const M ended = hn::And(sure, past);
  const M on = hn::AndNot(past, sure);
  const M on_x = hn::And(on, by_x);
  const M on_y = hn::AndNot(by_x, on);
  col_ = hn::IfThenElse(on_x, hn::Sub(border_x, behind_x_), hn::IfThenElse(on_y, other.cell, col_));
  row_ = hn::IfThenElse(on_y, hn::Sub(border_y, behind_y_), hn::IfThenElse(on_x, other.cell, row_));
  at_ = hn::IfThenElse(on, leave, at_);
  missed_ = hn::Or(missed_, ended);

  // Move up a level where the ray also leaves the block of the next level, unless that block cannot be clear.
  const V border = hn::Mul(hn::IfThenElse(by_x, border_col, border_row), constant(0.25));
  const M far = hn::Gt(hn::Mul(distance, rays_.horizontal_speed), hn::Mul(size, hn::Abs(rays_.dz)));
  const M rise = hn::And(hn::And(on, far), hn::Eq(border, hn::Floor(border)));
  const M finest = hn::Eq(size, one);
  const M sink = hn::AndNot(finest, stop);
  const Index i;
  const VI higher = hn::Min(hn::Add(level_, hn::Set(i, 1)), hn::Set(i, terrain.top_level));
  level_ = hn::IfThenElse(hn::RebindMask(i, rise), higher, level_);
  level_ = hn::IfThenElse(hn::RebindMask(i, sink), hn::Sub(level_, hn::Set(i, 1)), level_);
  waiting_ = hn::Or(waiting_, hn::And(stop, finest));
  searching_ = hn::Or(on, sink);
  passed_ = hn::AndNot(searching_, passed_);
  return any(searching_);
}

/// Distance to the surface in the lanes' cells; infinite for a miss, NaN where it is not certain.
HWY_INLINE V LaneWalk::range_in_cell(const WalkTerrain& terrain) {
  const D d;
  const V one = constant(1);
  const VI node = index_of(hn::Add(hn::Mul(row_, constant(static_cast<double>(terrain.node_cols))), col_));
  const V south_west = hn::GatherIndex(d, terrain.nodes, node);
  const V south_east = hn::GatherIndex(d, terrain.nodes + 1, node);
  const V north_west = hn::GatherIndex(d, terrain.nodes + terrain.node_cols, node);
  const V north_east = hn::GatherIndex(d, terrain.nodes + terrain.node_cols + 1, node);
  const V enter_z = hn::Add(rays_.z, hn::Mul(rays_.dz, at_));
  const M below = hn::And(hn::Lt(enter_z, south_west), hn::Lt(enter_z, north_east));
  side_ = hn::IfThenElse(below, constant(-1), constant(1));
  side_first_ = hn::IfThenElseZero(below, constant(terrain.to_lows));
  nears_ = hn::Xor(below, hn::Lt(rays_.dz, constant(0)));
  const V x = hn::Sub(rays_.x, col_);
  const V y = hn::Sub(rays_.y, row_);
  const V lower = CertainRange(rays_, {south_west, south_east, north_west, x, y, rays_.dx, rays_.dy});
  const V upper = CertainRange(rays_, {north_east, north_west, south_east, hn::Sub(one, x), hn::Sub(one, y),
                                       hn::Neg(rays_.dx), hn::Neg(rays_.dy)});
  // The minimum of NaN differs between instruction sets: choose by comparison, and propagate any NaN.
  const V nearer = hn::IfThenElse(hn::Lt(lower, upper), lower, upper);
  return hn::IfThenElse(hn::Eq(lower, lower), nearer, lower);
}

HWY_INLINE bool LaneWalk::find_range(const WalkTerrain& terrain) {
  const V range = range_in_cell(terrain);
  range_ = hn::IfThenElse(hn::And(waiting_, hn::Lt(range, infinity())), range, range_);
  passed_ = hn::And(waiting_, hn::Eq(range, infinity()));
  searching_ = passed_;
  waiting_ = hn::And(passed_, hn::Not(passed_));
  return any(searching_);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
