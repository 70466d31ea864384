// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/rotation.h"
#include "terrain/mesh/indexed_triangles.h"

namespace landfall {

/// Polygons as a mesh file has them: in its own units, whose vertices may be repeated or unused.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::uint32_t> corners;     ///< numbers of points, polygon after polygon
  std::vector<std::size_t> polygon_ends;  ///< where each polygon's corners end

  [[nodiscard]] std::span<const std::uint32_t> polygon(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : polygon_ends[i - 1];
    return std::span(corners).subspan(begin, polygon_ends[i] - begin);
  }
};

/// The placement of a mesh in frame D: a point p of the file comes to R (scale_m p) + translate_m, R as D7
/// has it.
struct MeshPlacement {
  double scale_m = 1;  ///< metres per unit of the file
  RollPitchYaw rotate = {};
  Eigen::Vector3d translate_m = Eigen::Vector3d::Zero();
};

/// A mesh of a soup, and what was left out of it. vertices + welded + unreferenced is the file's number of
/// points.
struct CleanMesh {
  IndexedTriangles mesh;
  std::size_t welded_vertex_count = 0;        ///< points with exactly the coordinates of an earlier one
  std::size_t unreferenced_vertex_count = 0;  ///< points of no triangle
  /// Polygons with fewer than three different corners in a row, and triangles without area (exactly).
  std::size_t degenerate_facet_count = 0;
};

/// Places the points, welds those that then have exactly the same coordinates (the first one stays), cuts
/// polygons into triangles (polygon_triangles.h), and leaves out what is degenerate or unused. Order is kept:
/// equal soups give equal meshes.
///
/// Throws FormatError, beginning with `name`, where a polygon names no point or has more than
/// kMaxPolygonCorners, a point is not finite or further than kLargestCoordinate_m out once placed, or no
/// triangle is left. O(n log n).
[[nodiscard]] CleanMesh clean_mesh(PolygonSoup soup, const MeshPlacement& placement, const std::string& name);

}  // namespace landfall
