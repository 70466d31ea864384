// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D6
#include "chain/terrain/relief/triangulated_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/error.h"
#include "chain/terrain/relief/incidence_cosines.h"

namespace landfall {

/// A point in a cell's own coordinates: u along x, v along y, both in [0, 1].
struct TriangulatedGrid::CellPosition {
  BinIndex cell;
  double u;
  double v;
};

CellOrigin CellOrigin::of_windows(const GridSpec& whole, double highest_abs_m) {
  CellOrigin origin;
  origin.anchor_ = 0x1.8p16;  // its last bit is worth 2^-36
  origin.whole_ = whole;
  origin.highest_abs_m_ = highest_abs_m;
  return origin;
}

bool CellOrigin::has_windows(const GridSpec& spec) {
  constexpr std::int64_t kFarthest = std::int64_t{1} << 15U;
  return spec.first_col > -kFarthest && spec.first_row > -kFarthest &&
         spec.first_col + spec.cols < kFarthest && spec.first_row + spec.rows < kFarthest;
}

TriangulatedGrid::TriangulatedGrid(Grid<double> nodes, const CellOrigin& origin)
    : nodes_(std::move(nodes)), origin_(origin) {
  if (nodes_.spec().rows < 2 || nodes_.spec().cols < 2)
    throw FormatError("a terrain grid needs at least 2 x 2 nodes");
}

[[gnu::always_inline]] inline double TriangulatedGrid::elevation_in_cell(const CellPosition& position) const {
  const auto [cell, u, v] = position;
  const double b = nodes_.at({cell.row, cell.col + 1});
  const double c = nodes_.at({cell.row + 1, cell.col});
  if (u + v <= 1) {
    const double a = nodes_.at(cell);
    const double z = a + u * (b - a) + v * (c - a);
    if (u + v < 1 || std::isfinite(z)) return z;
  }
  const double d = nodes_.at({cell.row + 1, cell.col + 1});
  return d + (1 - u) * (c - d) + (1 - v) * (b - d);
}

double TriangulatedGrid::elevation(double x_m, double y_m) const {
  const GridSpec& spec = nodes_.spec();
  const double gx = origin_.from_first(x_m / spec.resolution_m, spec.first_col);
  const double gy = origin_.from_first(y_m / spec.resolution_m, spec.first_row);
  const double last_col = static_cast<double>(spec.cols - 1);
  const double last_row = static_cast<double>(spec.rows - 1);
  if (!(gx >= 0 && gx <= last_col && gy >= 0 && gy <= last_row))
    return std::numeric_limits<double>::quiet_NaN();
  const BinIndex cell{std::min(static_cast<std::int64_t>(gy), spec.rows - 2),
                      std::min(static_cast<std::int64_t>(gx), spec.cols - 2)};
  const double u = gx - static_cast<double>(cell.col);
  const double v = gy - static_cast<double>(cell.row);
  double z = elevation_in_cell({cell, u, v});
  // On a border that a hole shares with its neighbours, any neighbour's triangle closes the surface.
  const bool has_left = u == 0 && cell.col > 0;
  const bool has_below = v == 0 && cell.row > 0;
  if (!std::isfinite(z) && has_left) z = elevation_in_cell({{cell.row, cell.col - 1}, 1, v});
  if (!std::isfinite(z) && has_below) z = elevation_in_cell({{cell.row - 1, cell.col}, u, 1});
  if (!std::isfinite(z) && has_left && has_below) z = elevation_in_cell({{cell.row - 1, cell.col - 1}, 1, 1});
  return z;
}

Eigen::Vector2d TriangulatedGrid::gradient(double x_m, double y_m) const {
  const GridSpec& spec = nodes_.spec();
  const double gx = origin_.from_first(x_m / spec.resolution_m, spec.first_col);
  const double gy = origin_.from_first(y_m / spec.resolution_m, spec.first_row);
  const auto cell_of = [](double position, std::int64_t count) {
    return static_cast<std::int64_t>(std::clamp(position, 0.0, static_cast<double>(count - 2)));
  };
  const BinIndex cell{cell_of(gy, spec.rows), cell_of(gx, spec.cols)};
  const bool is_lower = (gx - static_cast<double>(cell.col)) + (gy - static_cast<double>(cell.row)) <= 1;
  const double b = nodes_.at({cell.row, cell.col + 1});
  const double c = nodes_.at({cell.row + 1, cell.col});
  const double corner = nodes_.at(is_lower ? cell : BinIndex{cell.row + 1, cell.col + 1});
  const Eigen::Vector2d rise = is_lower ? Eigen::Vector2d(b - corner, c - corner)  //
                                        : Eigen::Vector2d(corner - c, corner - b);
  return rise / spec.resolution_m;
}

Eigen::Vector3d TriangulatedGrid::normal(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d slope = gradient(point.x(), point.y());
  return Eigen::Vector3d(-slope.x(), -slope.y(), 1).normalized();
}

void TriangulatedGrid::cosines(std::span<const Eigen::Vector3d> points,
                               std::span<const Eigen::Vector3d> directions, std::span<double> out) const {
  incidence_cosines(nodes_, origin_, points, directions, out);
}

std::size_t TriangulatedGrid::triangle_count() const {
  return 2 * static_cast<std::size_t>((nodes_.spec().rows - 1) * (nodes_.spec().cols - 1));
}

std::array<Eigen::Vector3d, 3> TriangulatedGrid::triangle(std::size_t id) const {
  const GridSpec& spec = nodes_.spec();
  const auto cell = static_cast<std::int64_t>(id / 2);
  const std::int64_t row = cell / (spec.cols - 1);
  const std::int64_t col = cell % (spec.cols - 1);
  const auto corner = [&](std::int64_t r, std::int64_t c) {
    return Eigen::Vector3d(spec.x(c), spec.y(r), nodes_.at({r, c}));
  };
  if (id % 2 == 0) return {corner(row, col), corner(row, col + 1), corner(row + 1, col)};
  return {corner(row, col + 1), corner(row + 1, col + 1), corner(row + 1, col)};
}

}  // namespace landfall
