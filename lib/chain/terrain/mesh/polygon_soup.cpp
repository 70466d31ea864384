// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D101
#include "chain/terrain/mesh/polygon_soup.h"

#include <algorithm>
#include <numeric>

#include "base/core/error.h"
#include "chain/terrain/mesh/polygon_triangles.h"

namespace landfall {
namespace {

void place_points(std::vector<Eigen::Vector3d>& points, const MeshPlacement& placement,
                  const std::string& name) {
  const Eigen::Matrix3d rotation = rotation_matrix(placement.rotate);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector3d& p = points[i];
    if (placement.y_up) p = Eigen::Vector3d(p.x(), -p.z(), p.y());
    p = rotation * (placement.scale_m * p) + placement.translate_m;
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kLargestCoordinate_m)
      throw FormatError(name + ": vertex " + std::to_string(i + 1) +
                        " is not finite, or more than 1e12 m from the origin after placement");
    p.array() += 0.0;  // -0 is 0
  }
}

/// For each point the first one with the same coordinates.
std::vector<std::uint32_t> first_in_place(const std::vector<Eigen::Vector3d>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3d& p = points[a];
    const Eigen::Vector3d& q = points[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    return p.z() != q.z() ? p.z() < q.z() : a < b;
  });
  std::vector<std::uint32_t> first(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_again = i > 0 && points[order[i]] == points[order[i - 1]];
    first[order[i]] = is_again ? first[order[i - 1]] : order[i];
  }
  return first;
}

/// Removes the corners of a polygon that repeat their neighbour.
void keep_distinct(std::span<const std::uint32_t> polygon, const std::vector<std::uint32_t>& first,
                   std::vector<std::uint32_t>& distinct) {
  distinct.clear();
  for (const std::uint32_t corner : polygon)
    if (distinct.empty() || first[corner] != distinct.back()) distinct.push_back(first[corner]);
  while (distinct.size() > 1 && distinct.front() == distinct.back()) distinct.pop_back();
}

void require_corners(std::span<const std::uint32_t> polygon, std::size_t number, std::size_t point_count,
                     const std::string& name) {
  const std::string which = name + ": facet " + std::to_string(number + 1);
  if (polygon.size() > kMaxPolygonCorners)
    throw FormatError(which + " has " + std::to_string(polygon.size()) + " corners, more than " +
                      std::to_string(kMaxPolygonCorners));
  for (const std::uint32_t corner : polygon)
    if (corner >= point_count)
      throw FormatError(which + " names vertex " + std::to_string(std::size_t{corner} + 1) + " of " +
                        std::to_string(point_count));
}

void cut_polygons(const PolygonSoup& soup, const std::vector<std::uint32_t>& first, const std::string& name,
                  CleanMesh& clean) {
  std::vector<TriangleCorners>& triangles = clean.mesh.triangles;
  std::vector<std::uint32_t> distinct;
  for (std::size_t i = 0; i < soup.polygon_ends.size(); ++i) {
    require_corners(soup.polygon(i), i, soup.points.size(), name);
    keep_distinct(soup.polygon(i), first, distinct);
    if (distinct.size() < 3)
      ++clean.degenerate_facet_count;
    else
      add_triangles(distinct, soup.points, triangles);
  }
  const auto is_flat = [&](const TriangleCorners& t) {
    return has_no_area({soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]});
  };
  clean.degenerate_facet_count += static_cast<std::size_t>(std::erase_if(triangles, is_flat));
}

/// Moves the points that triangles use into the mesh, in their order.
void keep_used(const std::vector<Eigen::Vector3d>& points, const std::vector<std::uint32_t>& first,
               CleanMesh& clean) {
  constexpr std::uint32_t kUnused = ~0U;
  std::vector<std::uint32_t> number(points.size(), kUnused);
  for (const TriangleCorners& t : clean.mesh.triangles)
    for (const std::uint32_t corner : t) number[corner] = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] != kUnused) {
      number[i] = static_cast<std::uint32_t>(clean.mesh.vertices.size());
      clean.mesh.vertices.push_back(points[i]);
    } else if (first[i] == i) {
      ++clean.unreferenced_vertex_count;
    } else {
      ++clean.welded_vertex_count;
    }
  }
  for (TriangleCorners& t : clean.mesh.triangles)
    for (std::uint32_t& corner : t) corner = number[corner];
}

}  // namespace

CleanMesh clean_mesh(PolygonSoup soup, const MeshPlacement& placement, const std::string& name) {
  if (soup.points.size() > kMaxMeshElements) throw FormatError(name + ": more than 2^31 - 1 vertices");
  place_points(soup.points, placement, name);
  const std::vector<std::uint32_t> first = first_in_place(soup.points);
  CleanMesh clean;
  cut_polygons(soup, first, name, clean);
  if (clean.mesh.triangles.empty()) throw FormatError(name + ": has no facet with an area");
  if (clean.mesh.triangles.size() > kMaxMeshElements)
    throw FormatError(name + ": more than 2^31 - 1 triangles");
  keep_used(soup.points, first, clean);
  return clean;
}

}  // namespace landfall
