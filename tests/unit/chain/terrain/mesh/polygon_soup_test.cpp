// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/mesh/polygon_soup.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/core/error.h"
#include "chain/terrain/mesh/polygon_triangles.h"
#include "mesh_shapes.h"
#include "refusal.h"

namespace landfall {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;
using Triangles = std::vector<TriangleCorners>;

CleanMesh clean(PolygonSoup soup) { return clean_mesh(std::move(soup), {}, "m.obj"); }

std::string soup_refusal(PolygonSoup soup, const MeshPlacement& placement = {}) {
  return refusal<FormatError>([&] { return clean_mesh(std::move(soup), placement, "m.obj"); });
}

// As STL has it: each triangle with corners of its own.
TEST(CleanMesh, WeldsPointsInOnePlace) {
  PolygonSoup soup;
  const IndexedTriangles cube = cube_mesh();
  for (std::size_t i = 0; i < cube.triangles.size(); ++i) {
    for (const Eigen::Vector3d& corner : cube.corners(i)) {
      soup.corners.push_back(static_cast<std::uint32_t>(soup.points.size()));
      soup.points.push_back(corner);
    }
    soup.polygon_ends.push_back(soup.corners.size());
  }
  const CleanMesh mesh = clean(soup);
  EXPECT_EQ(mesh.mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.welded_vertex_count, 28U);
  EXPECT_EQ(mesh.unreferenced_vertex_count + mesh.degenerate_facet_count, 0U);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(mesh.mesh.corners(i), cube.corners(i));
}

TEST(CleanMesh, OnlyExactlyEqualPlacesAreOne) {
  const CleanMesh mesh = clean(
      soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {1, 0, 1e-300}}, {{0, 1, 2}, {3, 4, 2}}));
  EXPECT_EQ(mesh.welded_vertex_count, 1U);
  EXPECT_EQ(mesh.mesh.triangles, (Triangles{{0, 1, 2}, {0, 3, 2}}));
}

TEST(CleanMesh, LeavesOutWhatIsDegenerateOrUnused) {
  const CleanMesh mesh = clean(soup_of({{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, 0, 0}},
                                       {{1, 2, 4}, {1, 2, 5}, {1, 2, 3}, {3, 3, 3}, {2, 3}}));
  EXPECT_EQ(mesh.degenerate_facet_count, 4U);
  EXPECT_EQ(mesh.welded_vertex_count, 1U);
  EXPECT_EQ(mesh.unreferenced_vertex_count, 2U);  // one of no facet, one of a degenerate one
  EXPECT_EQ(mesh.mesh.vertices, (Vectors{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.mesh.triangles, (Triangles{{0, 1, 2}}));
}

// A quad that two equal corners make a triangle, as at the poles of a globe.
TEST(CleanMesh, RepeatedCornersOfAPolygonAreOne) {
  const CleanMesh mesh = clean(soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.mesh.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(mesh.degenerate_facet_count, 0U);
}

TEST(CleanMesh, ScalesThenTurnsThenMoves) {
  const MeshPlacement placement{2, {0, 0, std::numbers::pi / 2}, {10, 20, 30}};
  const CleanMesh mesh = clean_mesh(soup_of({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}}), placement, "m");
  EXPECT_EQ(mesh.mesh.vertices, (Vectors{{10, 22, 30}, {8, 20, 30}, {10, 20, 32}}));
}

TEST(CleanMesh, Refuses) {
  const Vectors corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(soup_refusal(soup_of(corners, {{0, 1, 2}, {0, 1, 3}})), "m.obj: facet 2 names vertex 4 of 3");
  EXPECT_EQ(soup_refusal(soup_of(corners, {{0, 1, 1}})), "m.obj: has no facet with an area");
  EXPECT_EQ(soup_refusal(soup_of({}, {})), "m.obj: has no facet with an area");
  const std::string far =
      "m.obj: vertex 2 is not finite, or more than 1e12 m from the origin after placement";
  EXPECT_EQ(soup_refusal(soup_of(corners, {{0, 1, 2}}), {1.5e12, {}, {0, 0, 0}}), far);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(soup_refusal(soup_of({{0, 0, 0}, {0, nan, 0}, {0, 1, 0}}, {{0, 1, 2}})), far);
  PolygonSoup wide;
  wide.points.assign(257, {0, 0, 0});
  wide.corners.resize(257);
  std::iota(wide.corners.begin(), wide.corners.end(), 0U);
  wide.polygon_ends = {257};
  EXPECT_EQ(soup_refusal(wide), "m.obj: facet 1 has 257 corners, more than 256");
}

Triangles cut(const Vectors& vertices) {
  std::vector<std::uint32_t> polygon(vertices.size());
  std::iota(polygon.begin(), polygon.end(), 0U);
  Triangles triangles;
  add_triangles(polygon, vertices, triangles);
  return triangles;
}

/// Twice the signed areas' sum and the sum of their sizes, seen along z.
std::pair<double, double> areas(const Vectors& vertices, const Triangles& triangles) {
  double sum = 0;
  double sizes = 0;
  for (const TriangleCorners& t : triangles) {
    const Eigen::Vector3d& a = vertices[t[0]];
    const double area = (vertices[t[1]] - a).cross(vertices[t[2]] - a).z();
    sum += area;
    sizes += std::abs(area);
  }
  return {sum, sizes};
}

// An L, a dart and a comb: triangles that overlap or reach outside would have more area than the polygon.
TEST(AddTriangles, CutsPolygonsThatAreNotConvex) {
  const std::vector<std::pair<Vectors, double>> cases = {
      {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, 6},
      {{{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, 3, 0}}, 4},
      {{{0, 0, 0},
        {5, 0, 0},
        {5, 3, 0},
        {4, 3, 0},
        {4, 1, 0},
        {3, 1, 0},
        {3, 3, 0},
        {2, 3, 0},
        {2, 1, 0},
        {1, 1, 0},
        {1, 3, 0},
        {0, 3, 0}},
       22}};
  for (const auto& [outline, expected] : cases) {
    Vectors vertices = outline;
    for (int turned = 0; turned < 2; ++turned) {
      for (std::size_t start = 0; start < vertices.size(); ++start) {
        const auto triangles = cut(vertices);
        ASSERT_EQ(triangles.size(), vertices.size() - 2);
        const auto [sum, sizes] = areas(vertices, triangles);
        EXPECT_EQ(sum, turned == 0 ? expected : -expected);
        EXPECT_EQ(sizes, expected);
        std::rotate(vertices.begin(), vertices.begin() + 1, vertices.end());
      }
      std::reverse(vertices.begin(), vertices.end());
    }
  }
}

TEST(AddTriangles, CutsAnyPlane) {
  Vectors vertices = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, 3, 0}};
  for (Eigen::Vector3d& v : vertices) v = Eigen::Vector3d(7, v.x(), v.y());
  EXPECT_EQ(cut(vertices), (Triangles{{1, 2, 3}, {0, 1, 3}}));
}

TEST(AddTriangles, CornerOnAnEdgeMakesNoFlatTriangle) {
  const Vectors vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  for (const TriangleCorners& t : cut(vertices))
    EXPECT_FALSE(has_no_area({vertices[t[0]], vertices[t[1]], vertices[t[2]]}));
}

TEST(AddTriangles, APolygonThatCrossesItselfIsAFan) {
  const Vectors bow = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(cut(bow).size(), 2U);
}

}  // namespace
}  // namespace landfall
