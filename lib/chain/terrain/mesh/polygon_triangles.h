// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "chain/terrain/mesh/indexed_triangles.h"

namespace landfall {

/// The most corners of a polygon: ear clipping takes up to the cube of them.
inline constexpr std::size_t kMaxPolygonCorners = 256;

/// Divides a polygon of 3 to kMaxPolygonCorners corners into triangles with the same corners and orientation,
/// and adds them.
///
/// Clips ears: seen along the axis of its largest area (Newell), the first convex corner whose triangle
/// holds no other corner, counted from the second corner. So a polygon that is not convex is divided
/// correctly, and neighbours keep their common edges. Where no such ear is left (the polygon intersects
/// itself), the rest is divided as a fan about its first corner. A polygon that is not planar is bent along
/// the cuts.
void add_triangles(std::span<const std::uint32_t> polygon, const std::vector<Eigen::Vector3d>& vertices,
                   std::vector<TriangleCorners>& triangles);

}  // namespace landfall
