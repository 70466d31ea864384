// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace landfall {

/// Three numbers of vertices.
using TriangleCorners = std::array<std::uint32_t, 3>;

/// Triangles that share vertices, frame D, metres.
struct IndexedTriangles {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<TriangleCorners> triangles;

  [[nodiscard]] std::array<Eigen::Vector3d, 3> corners(std::size_t triangle) const {
    const TriangleCorners& t = triangles[triangle];
    return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
  }
};

/// The largest coordinate of a vertex, metres: further out than any body's surface, and far from where
/// products of coordinates overflow.
inline constexpr double kLargestCoordinate_m = 1e12;
/// The most vertices and the most triangles of a mesh: files number them in 32 bits with a sign.
inline constexpr std::size_t kMaxMeshElements = 2147483647;

/// True where the corners lie exactly on one line, including two or all of them at one point.
[[nodiscard]] bool has_no_area(const std::array<Eigen::Vector3d, 3>& corners);

/// Throws FormatError beginning with `name` unless there is a triangle, every vertex is within
/// kLargestCoordinate_m of 0 in each coordinate, every corner is a vertex, and every triangle has an area.
void require_sound(const IndexedTriangles& mesh, const std::string& name);

}  // namespace landfall
