// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/ray/pyramid_traversal.h"

#include <algorithm>

namespace landfall {
namespace {

double largest_height(const ElevationPyramid& pyramid) {
  const bool empty = pyramid.lowest() > pyramid.highest();
  return empty ? 0 : std::max(std::abs(double{pyramid.lowest()}), std::abs(double{pyramid.highest()}));
}

}  // namespace

Heightfield::Heightfield(const TriangulatedGrid& surface, const ProgressCallback& progress)
    : terrain(surface),
      pyramid(surface.nodes(), progress),
      frame(surface.nodes().spec(), largest_height(pyramid), surface.origin()) {}

PyramidTraversal::PyramidTraversal(const Heightfield& field, const Ray& ray)
    : field_(field),
      ray_(ray),
      grid_ray_(field.frame, ray),
      inverse_direction_(ray.direction.v.array().inverse()) {}

double PyramidTraversal::first_hit() {
  visit_block(field_.pyramid.level_count() - 1, {0, 0});
  return std::isinf(best_m_) ? std::numeric_limits<double>::quiet_NaN() : best_m_;
}

PyramidTraversal::Interval PyramidTraversal::within(Eigen::Index axis, double low, double high,
                                                    Interval interval) const {
  low -= ray_.origin.v[axis];
  high -= ray_.origin.v[axis];
  const double inverse = inverse_direction_[axis];
  if (std::isinf(inverse)) return low > 0 || high < 0 ? Interval{1, 0} : interval;
  return {std::max(interval.enter, std::min(low * inverse, high * inverse)),
          std::min(interval.leave, std::max(low * inverse, high * inverse))};
}

void PyramidTraversal::visit_block(int level, BinIndex block) {
  const ElevationPyramid::Level& blocks = field_.pyramid.level(level);
  if (block.row >= blocks.rows || block.col >= blocks.cols) return;
  const GridSpec& spec = field_.spec();
  const std::int64_t cells = ElevationPyramid::block_cells(level);
  const ElevationPyramid::Bounds bounds = field_.pyramid.bounds(level, block);
  if (bounds.empty()) return;  // the surface consists of holes
  Interval interval{0, best_m_};
  interval = within(2, bounds.low, bounds.high, interval);
  interval = within(0, spec.x(block.col * cells), spec.x(std::min((block.col + 1) * cells, spec.cols - 1)),
                    interval);
  interval = within(1, spec.y(block.row * cells), spec.y(std::min((block.row + 1) * cells, spec.rows - 1)),
                    interval);
  if (interval.empty()) return;
  if (level > 1)
    visit_children(level - 1, {2 * block.row, 2 * block.col});
  else
    visit_cells({block.row * cells, block.col * cells});
}

void PyramidTraversal::visit_children(int level, BinIndex first) {
  const std::int64_t near_row = ray_.direction.v.y() < 0 ? 1 : 0;
  const std::int64_t near_col = ray_.direction.v.x() < 0 ? 1 : 0;
  visit_block(level, {first.row + near_row, first.col + near_col});
  visit_block(level, {first.row + near_row, first.col + 1 - near_col});
  visit_block(level, {first.row + 1 - near_row, first.col + near_col});
  visit_block(level, {first.row + 1 - near_row, first.col + 1 - near_col});
}

void PyramidTraversal::visit_cells(BinIndex first) {
  constexpr std::int64_t kFinest = ElevationPyramid::block_cells(1);
  const GridSpec& spec = field_.spec();
  const std::int64_t end_row = std::min(first.row + kFinest, spec.rows - 1);
  const std::int64_t end_col = std::min(first.col + kFinest, spec.cols - 1);
  for (std::int64_t row = first.row; row < end_row; ++row) {
    const Interval in_row = within(1, spec.y(row), spec.y(row + 1), {0, best_m_});
    if (in_row.empty()) continue;
    for (std::int64_t col = first.col; col < end_col; ++col)
      visit_cell({row, col}, within(0, spec.x(col), spec.x(col + 1), in_row));
  }
}

void PyramidTraversal::visit_cell(BinIndex cell, Interval interval) {
  if (interval.empty()) return;
  const Grid<double>& nodes = field_.terrain.nodes();
  const std::size_t node = nodes.spec().index(cell);
  const double* const south = &nodes.values()[node];
  const double* const north = south + nodes.spec().cols;
  const double x = grid_ray_.x - static_cast<double>(cell.col);
  const double y = grid_ray_.y - static_cast<double>(cell.row);
  const auto id = static_cast<std::size_t>(cell.row * (nodes.spec().cols - 1) + cell.col);
  best_m_ =
      std::min(best_m_, range_to(2 * id, {south[0], south[1], north[0], x, y, grid_ray_.dx, grid_ray_.dy}));
  best_m_ = std::min(best_m_, range_to(2 * id + 1, {north[1], north[0], south[1], 1 - x, 1 - y, -grid_ray_.dx,
                                                    -grid_ray_.dy}));
}

double PyramidTraversal::range_to(std::size_t triangle, const CornerTriangle& corner_triangle) {
  const double certain = certain_range(grid_ray_, corner_triangle);
  if (!std::isnan(certain)) return certain;
  if (!watertight_) watertight_.emplace(ray_);
  return watertight_->range_to(field_.terrain.triangle(triangle));
}

}  // namespace landfall
