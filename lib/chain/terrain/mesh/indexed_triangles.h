// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace landfall {

/// The indices of a triangle's three vertices.
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

/// The largest coordinate of a vertex, metres: beyond the surface of any body, and far below the range where
/// products of coordinates overflow.
inline constexpr double kLargestCoordinate_m = 1e12;
/// The most vertices and the most triangles of a mesh: files index them with signed 32-bit integers.
inline constexpr std::size_t kMaxMeshElements = 2147483647;

/// True where the corners are exactly collinear, including coincident corners.
[[nodiscard]] bool has_no_area(const std::array<Eigen::Vector3d, 3>& corners);

/// Throws FormatError beginning with `name` unless there is a triangle, every vertex is within
/// kLargestCoordinate_m of 0 in each coordinate, every corner is a vertex, and every triangle has an area.
void require_sound(const IndexedTriangles& mesh, const std::string& name);

}  // namespace landfall
