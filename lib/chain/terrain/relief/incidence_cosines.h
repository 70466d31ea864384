// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/raster/grid.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// TriangulatedGrid::cosines() in SIMD lanes: out[i] = |n . directions[i]|, n the unit normal of the triangle
/// above or below points[i] (metres, frame D; of the nearest cell off the grid); NaN in holes.
void incidence_cosines(const Grid<double>& nodes, const CellOrigin& origin,
                       std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> directions,
                       std::span<double> out);

}  // namespace landfall
