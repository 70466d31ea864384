// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <random>
#include <utility>

#include "chain/terrain/mesh/indexed_triangles.h"
#include "chain/terrain/mesh/polygon_soup.h"

namespace landfall {

inline PolygonSoup soup_of(std::vector<Eigen::Vector3d> points,
                           std::initializer_list<std::initializer_list<std::uint32_t>> polygons) {
  PolygonSoup soup;
  soup.points = std::move(points);
  for (const auto& polygon : polygons) {
    soup.corners.insert(soup.corners.end(), polygon.begin(), polygon.end());
    soup.polygon_ends.push_back(soup.corners.size());
  }
  return soup;
}

/// Adds a box of 12 triangles, counter-clockwise as seen from outside.
inline void add_box(IndexedTriangles& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

inline IndexedTriangles cube_mesh() {
  IndexedTriangles mesh;
  add_box(mesh, {-1, -1, -1}, {1, 1, 1});
  return mesh;
}

/// A stem of 2 m by 2 m and 3 m high under a cap of 6 m by 6 m, from z = 3 to 4.
inline IndexedTriangles mushroom_mesh() {
  IndexedTriangles mesh;
  add_box(mesh, {-1, -1, 0}, {1, 1, 3});
  add_box(mesh, {-3, -3, 3}, {3, 3, 4});
  return mesh;
}

/// Corners (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1).
inline IndexedTriangles tetrahedron_mesh() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

/// An octahedron, each triangle divided into four `steps` times, the vertices on the unit sphere.
inline IndexedTriangles sphere_mesh(int steps) {
  IndexedTriangles mesh{
      {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}}};
  for (int step = 0; step < steps; ++step) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return entry->second;
    };
    std::vector<TriangleCorners> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// A uniform number in [low, high).
inline double random_in(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

/// Triangles of any shape, size and attitude within 10 m of the origin, which intersect each other.
inline IndexedTriangles random_mesh(std::mt19937_64& random, std::size_t count) {
  const auto vector = [&](double size) {
    const double x = random_in(random, -size, size);
    const double y = random_in(random, -size, size);
    return Eigen::Vector3d(x, y, random_in(random, -size, size));
  };
  IndexedTriangles mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d centre = vector(8);
    const double size = std::exp(random_in(random, -5, 0.7));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) mesh.vertices.emplace_back(centre + vector(size));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// A closed sheet over the square |x|, |y| <= 1 without straight lines: the inner of (cells + 1)^2 nodes are
/// moved randomly in the plane, all nodes randomly in height.
inline IndexedTriangles rough_sheet(std::mt19937_64& random, std::uint32_t cells) {
  IndexedTriangles mesh;
  const double step = 2.0 / cells;
  for (std::uint32_t row = 0; row <= cells; ++row)
    for (std::uint32_t col = 0; col <= cells; ++col) {
      const bool is_inner = row > 0 && row < cells && col > 0 && col < cells;
      const double shift = is_inner ? 0.3 * step : 0;
      const double x = -1 + col * step + random_in(random, -shift, shift);
      const double y = -1 + row * step + random_in(random, -shift, shift);
      mesh.vertices.emplace_back(col == cells ? 1 : x, row == cells ? 1 : y, random_in(random, -1, 1));
    }
  for (std::uint32_t row = 0; row < cells; ++row)
    for (std::uint32_t col = 0; col < cells; ++col) {
      const std::uint32_t a = row * (cells + 1) + col;
      const std::uint32_t c = a + cells + 1;
      mesh.triangles.push_back({a, a + 1, c});
      mesh.triangles.push_back({a + 1, c + 1, c});
    }
  return mesh;
}

}  // namespace landfall
