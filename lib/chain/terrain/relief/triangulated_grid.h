// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/raster/grid.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// How a position, in cells from the site centre, is expressed relative to a grid's first node. By default
/// that node is subtracted, and the rounding depends on which node is the first.
///
/// A window of a terrain must give the answers of the whole terrain, bit for bit. Positions on such terrains
/// are first rounded to 2^-36 cells: within 2^15 cells of the site centre all further steps are then exact
/// for any first node. This moves a position by less than 1e-11 cells.
class CellOrigin {
 public:
  CellOrigin() = default;
  /// `whole`: the terrain's nodes; `highest_abs_m`: a bound of its |elevation|. These, not the window's
  /// values, give the bounds of rounding errors.
  [[nodiscard]] static CellOrigin of_windows(const GridSpec& whole, double highest_abs_m);
  /// True if windows of a terrain with these nodes give the answers of the whole terrain.
  [[nodiscard]] static bool has_windows(const GridSpec& spec);

  [[nodiscard]] double from_first(double cells, std::int64_t first_node) const {
    return (cells + anchor_) - (anchor_ + static_cast<double>(first_node));
  }
  [[nodiscard]] double anchor() const { return anchor_; }
  [[nodiscard]] const std::optional<GridSpec>& whole() const { return whole_; }
  [[nodiscard]] double highest_abs_m() const { return highest_abs_m_; }

 private:
  double anchor_ = 0;
  std::optional<GridSpec> whole_;
  double highest_abs_m_ = 0;
};

/// The true surface of a gridded terrain: each cell of four nodes is split along the diagonal from node (col
/// + 1, row) to node (col, row + 1) into two triangles. Rays and elevation() use this same surface, never
/// another interpolation.
///
/// A triangle with a NaN node is a hole; the other triangle of its cell stays (D6).
class TriangulatedGrid final : public TerrainSurface {
 public:
  /// Throws FormatError unless the grid has at least 2 x 2 nodes.
  explicit TriangulatedGrid(Grid<double> nodes, const CellOrigin& origin = {});

  [[nodiscard]] const CellOrigin& origin() const { return origin_; }

  [[nodiscard]] const Grid<double>& nodes() const { return nodes_; }
  /// Returns the grid; the surface must not be used afterwards.
  [[nodiscard]] Grid<double> take_nodes() && { return std::move(nodes_); }

  /// H(x, y), metres, frame D; NaN off the grid and in holes. The surface is closed: on an edge or node that
  /// a hole shares with a triangle, the triangle counts.
  [[nodiscard]] double elevation(double x_m, double y_m) const override;

  /// (dH/dx, dH/dy) of the triangle at (x, y), both finite. A point off the grid gets the gradient of the
  /// nearest cell; NaN in holes. On an edge or node, one of the triangles that share it is used.
  [[nodiscard]] Eigen::Vector2d gradient(double x_m, double y_m) const;

  /// Upward normal, from gradient() at the point's x and y.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point) const override;

  void cosines(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> directions,
               std::span<double> out) const override;

  /// Triangles are numbered by cell, row-major: 2 cell is the lower left one, 2 cell + 1 the upper right one.
  /// Holes keep their numbers.
  [[nodiscard]] std::size_t triangle_count() const;
  /// The corners, counter-clockwise seen from above; some are NaN in a hole.
  [[nodiscard]] std::array<Eigen::Vector3d, 3> triangle(std::size_t id) const;

 private:
  struct CellPosition;
  [[nodiscard]] double elevation_in_cell(const CellPosition& position) const;

  Grid<double> nodes_;
  CellOrigin origin_;
};

}  // namespace landfall
