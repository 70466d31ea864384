// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <limits>

#include "base/raster/grid_spec.h"
#include "chain/ray/engine.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// How rays on a heightfield become GridRays, and the bounds of the numbers involved.
struct GridFrame {
  double cells_per_m = 1;
  double first_col = 0;
  double first_row = 0;
  double extent_cells = 0;  ///< bound of |first index| + number of cells, over both axes
  double height_m = 0;      ///< bound of |elevation|
  double anchor = 0;        ///< CellOrigin's anchor

  GridFrame(const GridSpec& spec, double highest_abs_m, const CellOrigin& origin = {})
      : cells_per_m(1 / spec.resolution_m),
        first_col(static_cast<double>(spec.first_col)),
        first_row(static_cast<double>(spec.first_row)),
        extent_cells(extent_of(origin.whole().value_or(spec))),
        height_m(origin.whole() ? origin.highest_abs_m() : highest_abs_m),
        anchor(origin.anchor()) {
    // The rounding of CellOrigin, 2^-37 cells along each axis, as a part of GridRay::position_error.
    if (anchor != 0) extent_cells += 0x1p-36 / (64 * 0x1p-53);
  }

 private:
  static double extent_of(const GridSpec& spec) {
    return static_cast<double>(std::abs(spec.first_col) + std::abs(spec.first_row) + spec.cols + spec.rows);
  }
};

/// A ray with x and y counted in cells from node (0, 0), z and the range in metres, with bounds of the
/// rounding errors of the values computed from it. With 2^-53 the unit of rounding and some 10 operations per
/// result, wherever the ray is inside the grid and within the terrain's heights,
/// - its position in cells errs by less than position_error + horizontal_speed * (error of the range);
/// - its range to the plane of a cell's triangle errs by less than
///   (height_error + (|slope x| + |slope y|) * position_error) / |descent relative to the plane|.
/// The 64 units of kRounding leave a margin of a factor of at least 4 in each bound.
struct GridRay {
  static constexpr double kRounding = 64 * 0x1p-53;
  static constexpr double kSharp_m = 1e-9;  ///< the largest error of a range that counts as certain

  double x, y, z;
  double dx, dy, dz;
  double position_error;    ///< cells
  double height_error;      ///< metres
  double horizontal_speed;  ///< |dx| + |dy|, cells per metre

  GridRay(const GridFrame& frame, const Ray& ray) {
    const double x_cells = ray.origin.v.x() * frame.cells_per_m;
    const double y_cells = ray.origin.v.y() * frame.cells_per_m;
    x = (x_cells + frame.anchor) - (frame.anchor + frame.first_col);
    y = (y_cells + frame.anchor) - (frame.anchor + frame.first_row);
    z = ray.origin.v.z();
    dx = ray.direction.v.x() * frame.cells_per_m;
    dy = ray.direction.v.y() * frame.cells_per_m;
    dz = ray.direction.v.z();
    position_error = kRounding * ((std::abs(x_cells) + std::abs(y_cells)) + frame.extent_cells);
    height_error = kRounding * (std::abs(z) + frame.height_m);
    horizontal_speed = std::abs(dx) + std::abs(dy);
  }
};

/// One triangle of a cell, seen from its right-angled corner: the elevation of that corner and of the two
/// corners along x and y, and the ray in coordinates that put the corner at 0 and the other two at (1, 0) and
/// (0, 1).
struct CornerTriangle {
  double corner, along_x, along_y;
  double x, y;
  double dx, dy;
};

/// Distance to the triangle, metres, where double precision decides: infinite for a certain miss, NaN where
/// the ray passes so close to an edge, so flat over the plane or starts so close to it that rounding might
/// matter. A hit errs by less than 1e-9 m by the bound above; the measured error is below 1e-10 m.
inline double certain_range(const GridRay& ray, const CornerTriangle& t) {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  const double slope_x = t.along_x - t.corner;
  const double slope_y = t.along_y - t.corner;
  const double steepness = std::abs(slope_x) + std::abs(slope_y);
  if (!(steepness - steepness == 0)) return kMiss;  // a corner is not finite
  const double per_descent = 1 / ((ray.dz - slope_x * t.dx) - slope_y * t.dy);
  const double range = (((t.corner - ray.z) + slope_x * t.x) + slope_y * t.y) * per_descent;
  const double range_error = (ray.height_error + steepness * ray.position_error) * std::abs(per_descent);
  const double margin = ray.position_error + ray.horizontal_speed * range_error;
  const double u = t.x + t.dx * range;
  const double v = t.y + t.dy * range;
  const double w = (1 - u) - v;
  if (range < -range_error || u < -margin || v < -margin || w < -margin) return kMiss;
  const bool certain =
      range > range_error && range_error < GridRay::kSharp_m && u > margin && v > margin && w > margin;
  return certain ? range : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace landfall
