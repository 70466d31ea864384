// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D102
#include "chain/terrain/mesh/polygon_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

#include "chain/terrain/mesh/orient2d.h"

namespace landfall {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A corner of the remaining polygon.
struct Corner {
  std::uint32_t vertex;
  Vector2d seen;  ///< projected so that the polygon is counter-clockwise
};

/// A vector along the normal with twice the area as its length.
Vector3d newell_normal(std::span<const std::uint32_t> polygon, const std::vector<Vector3d>& vertices) {
  Vector3d normal = Vector3d::Zero();
  const Vector3d& first = vertices[polygon[0]];
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    normal += (vertices[polygon[i]] - first).cross(vertices[polygon[i + 1]] - first);
  return normal;
}

std::vector<Corner> seen_along_normal(std::span<const std::uint32_t> polygon,
                                      const std::vector<Vector3d>& vertices) {
  const Vector3d normal = newell_normal(polygon, vertices);
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Index u = (axis + 1) % 3;
  const Eigen::Index v = (axis + 2) % 3;
  std::vector<Corner> corners;
  for (const std::uint32_t vertex : polygon) {
    const Vector3d& at = vertices[vertex];
    corners.push_back({vertex, normal[axis] < 0 ? Vector2d(at[v], at[u]) : Vector2d(at[u], at[v])});
  }
  return corners;
}

bool holds(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& point) {
  return orient2d(a, b, point) >= 0 && orient2d(b, c, point) >= 0 && orient2d(c, a, point) >= 0;
}

bool is_ear(const std::vector<Corner>& corners, std::size_t i) {
  const Corner& before = corners[(i + corners.size() - 1) % corners.size()];
  const Corner& tip = corners[i];
  const Corner& after = corners[(i + 1) % corners.size()];
  if (orient2d(before.seen, tip.seen, after.seen) <= 0) return false;
  return std::none_of(corners.begin(), corners.end(), [&](const Corner& other) {
    const bool is_own =
        other.vertex == before.vertex || other.vertex == tip.vertex || other.vertex == after.vertex;
    return !is_own && holds(before.seen, tip.seen, after.seen, other.seen);
  });
}

}  // namespace

void add_triangles(std::span<const std::uint32_t> polygon, const std::vector<Vector3d>& vertices,
                   std::vector<TriangleCorners>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  std::vector<Corner> left = seen_along_normal(polygon, vertices);
  while (left.size() > 3) {
    std::size_t ear = 1;
    while (ear <= left.size() && !is_ear(left, ear % left.size())) ++ear;
    const std::size_t tip = ear <= left.size() ? ear % left.size() : 1;
    const Corner& before = left[(tip + left.size() - 1) % left.size()];
    triangles.push_back({before.vertex, left[tip].vertex, left[(tip + 1) % left.size()].vertex});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(tip));
  }
  triangles.push_back({left[0].vertex, left[1].vertex, left[2].vertex});
}

}  // namespace landfall
