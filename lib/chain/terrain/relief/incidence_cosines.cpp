// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/incidence_cosines.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/terrain/relief/incidence_cosines.cpp"
#include "base/numerics/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// As in TriangulatedGrid::gradient(), the same operations in the same order.
void IncidenceCosines(const Grid<double>& nodes, const CellOrigin& origin, const Eigen::Vector3d* points,
                      const Eigen::Vector3d* directions, double* out, std::size_t count) {
  using Index = hn::RebindToSigned<D>;
  // The low bits of 2^52 + n hold the integer n, on every target.
  const auto index_of = [](V n) {
    return hn::And(hn::BitCast(Index(), hn::Add(n, constant(0x1p52))), hn::Set(Index(), 0x000fffffffffffff));
  };
  const GridSpec& spec = nodes.spec();
  const double* const z = nodes.values().data();
  const auto cols = static_cast<double>(spec.cols);
  const V resolution_m = constant(spec.resolution_m);
  const V anchor = constant(origin.anchor());
  const V zero = constant(0);
  const V one = constant(1);
  const auto from_first = [&](V position_m, std::int64_t first) {
    const V cells = hn::Add(hn::Div(position_m, resolution_m), anchor);
    return hn::Sub(cells, constant(origin.anchor() + static_cast<double>(first)));
  };
  const auto cell_of = [&](V position, std::int64_t nodes_along) {
    return hn::Floor(hn::Min(hn::Max(position, zero), constant(static_cast<double>(nodes_along - 2))));
  };
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    V x_m, y_m, z_m, dx, dy, dz;
    hn::LoadInterleaved3(D(), points[i].data(), x_m, y_m, z_m);
    hn::LoadInterleaved3(D(), directions[i].data(), dx, dy, dz);
    const V gx = from_first(x_m, spec.first_col);
    const V gy = from_first(y_m, spec.first_row);
    const V col = cell_of(gx, spec.cols);
    const V row = cell_of(gy, spec.rows);
    const M is_lower = hn::Le(hn::Add(hn::Sub(gx, col), hn::Sub(gy, row)), one);
    const V node = hn::Add(hn::Mul(row, constant(cols)), col);
    const V b = hn::GatherIndex(D(), z, index_of(hn::Add(node, one)));
    const V c = hn::GatherIndex(D(), z, index_of(hn::Add(node, constant(cols))));
    const V corner =
        hn::GatherIndex(D(), z, index_of(hn::IfThenElse(is_lower, node, hn::Add(node, constant(cols + 1)))));
    const V rise_x = hn::IfThenElse(is_lower, hn::Sub(b, corner), hn::Sub(corner, c));
    const V rise_y = hn::IfThenElse(is_lower, hn::Sub(c, corner), hn::Sub(corner, b));
    const V slope_x = hn::Div(rise_x, resolution_m);
    const V slope_y = hn::Div(rise_y, resolution_m);
    const V along = hn::Sub(hn::Sub(dz, hn::Mul(slope_x, dx)), hn::Mul(slope_y, dy));
    const V square = hn::Add(hn::Add(one, hn::Mul(slope_x, slope_x)), hn::Mul(slope_y, slope_y));
    hn::StoreU(hn::Div(hn::Abs(along), hn::Sqrt(square)), D(), out + i);
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(IncidenceCosines);

void incidence_cosines(const Grid<double>& nodes, const CellOrigin& origin,
                       std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> directions,
                       std::span<double> out) {
  assert(points.size() == directions.size() && points.size() == out.size());
  constexpr std::size_t kBlock = 8;  // a multiple of every target's lanes
  const std::size_t whole = points.size() / kBlock * kBlock;
  HWY_DYNAMIC_DISPATCH(IncidenceCosines)(nodes, origin, points.data(), directions.data(), out.data(), whole);
  if (whole == points.size()) return;
  std::array<Eigen::Vector3d, kBlock> last_points;
  std::array<Eigen::Vector3d, kBlock> last_directions;
  std::array<double, kBlock> last_out;
  last_points.fill(points[whole]);
  last_directions.fill(directions[whole]);
  std::ranges::copy(points.subspan(whole), last_points.begin());
  std::ranges::copy(directions.subspan(whole), last_directions.begin());
  HWY_DYNAMIC_DISPATCH(IncidenceCosines)
  (nodes, origin, last_points.data(), last_directions.data(), last_out.data(), kBlock);
  std::copy_n(last_out.begin(), points.size() - whole, out.begin() + static_cast<std::ptrdiff_t>(whole));
}

}  // namespace landfall
#endif
