// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/geometry/rotation.h"
#include "chain/terrain/mesh/indexed_triangles.h"

namespace landfall {

/// Polygons of a mesh file in the file's units. Vertices may be repeated or unused.
struct PolygonSoup {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::uint32_t> corners;     ///< numbers of points, polygon after polygon
  std::vector<std::size_t> polygon_ends;  ///< where each polygon's corners end
  std::vector<std::string> unread;        ///< other contents of the file, for a warning

  [[nodiscard]] std::span<const std::uint32_t> polygon(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : polygon_ends[i - 1];
    return std::span(corners).subspan(begin, polygon_ends[i] - begin);
  }
};

/// The placement of a mesh in frame D: a point p of the file is moved to R (scale_m p) + translate_m, R as in
/// D7; with y_up, p is (x, -z, y) of the file's (x, y, z).
struct MeshPlacement {
  double scale_m = 1;  ///< metres per unit of the file
  RollPitchYaw rotate = {};
  Eigen::Vector3d translate_m = Eigen::Vector3d::Zero();
  bool y_up = false;
};

/// A mesh made from a soup, and the omitted parts. vertices + welded + unreferenced is the file's
/// number of points.
struct CleanMesh {
  IndexedTriangles mesh;
  std::size_t welded_vertex_count = 0;        ///< points with exactly the coordinates of an earlier one
  std::size_t unreferenced_vertex_count = 0;  ///< points that no triangle uses
  /// Polygons with fewer than three distinct consecutive corners, and triangles of exactly zero area.
  std::size_t degenerate_facet_count = 0;
};

/// Places the points, welds those that then have exactly the same coordinates (the first one stays), divides
/// polygons into triangles (polygon_triangles.h), and omits degenerate and unused elements. The order is
/// kept: equal soups give equal meshes.
///
/// Throws FormatError, beginning with `name`, where a polygon names a missing point or has more than
/// kMaxPolygonCorners, where a placed point is not finite or farther out than kLargestCoordinate_m, or if no
/// triangle is left. O(n log n).
[[nodiscard]] CleanMesh clean_mesh(PolygonSoup soup, const MeshPlacement& placement, const std::string& name);

}  // namespace landfall
