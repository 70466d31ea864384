// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "chain/terrain/mesh/indexed_triangles.h"
#include "chain/terrain/mesh/triangle_tree.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// The true surface of a mesh terrain: any set of triangles. They need not form a closed surface, and they
/// may overhang, be vertical and intersect each other; the orientation of their corners does not matter.
class TriangleMesh final : public TerrainSurface {
 public:
  /// Throws FormatError, beginning with `name`, where require_sound() does. O(n log n); the tree takes some
  /// 16 bytes per triangle.
  explicit TriangleMesh(IndexedTriangles mesh, const std::string& name = "mesh");

  [[nodiscard]] const IndexedTriangles& data() const { return mesh_; }
  [[nodiscard]] std::size_t triangle_count() const { return mesh_.triangles.size(); }
  [[nodiscard]] std::array<Eigen::Vector3d, 3> triangle(std::size_t id) const { return mesh_.corners(id); }

  /// The highest point of all triangles on the vertical, metres; NaN off the mesh. Triangles are closed, and
  /// the ones that a vertical meets are found without rounding, so that it never slips between neighbours; a
  /// vertical triangle counts with its highest point there. Rounding of z: a few units of 2^-63 of the
  /// triangle's height times its steepness, and never beyond its corners. O(log n).
  [[nodiscard]] double elevation(double x_m, double y_m) const override;

  /// The normal of the triangle nearest to the point, the first of equally near ones. The order of the
  /// corners gives its sense: outwards for a body whose corners are counter-clockwise as seen from outside.
  /// NaN for a point that is not finite. O(log n) near the surface.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point) const override;

  /// A mesh may overhang: the floor of a cave lies below its roof.
  [[nodiscard]] bool is_terrain_below() const override { return false; }

 private:
  IndexedTriangles mesh_;
  TriangleTree tree_;
};

}  // namespace landfall
