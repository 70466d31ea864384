// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "terrain/mesh/indexed_triangles.h"

namespace landfall {

/// The most corners of a polygon: cutting ears takes up to the cube of them.
inline constexpr std::size_t kMaxPolygonCorners = 256;

/// Cuts a polygon of 3 to kMaxPolygonCorners corners into triangles with its corners and its sense, and adds
/// them.
///
/// Ears are cut: seen along the axis of its largest area (Newell), the first corner that turns the polygon's
/// way and whose triangle holds no other corner, counted from the second corner on. So a polygon that is not
/// convex is cut right, and neighbours keep their common edges. Where no such ear is left (the polygon
/// crosses itself), the rest is cut as a fan about its first corner. A polygon that is not flat is bent along
/// the cuts.
void add_triangles(std::span<const std::uint32_t> polygon, const std::vector<Eigen::Vector3d>& vertices,
                   std::vector<TriangleCorners>& triangles);

}  // namespace landfall
