// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/mesh/triangle_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/core/error.h"
#include "chain/terrain/mesh/orient2d.h"
#include "constants.h"
#include "mesh_shapes.h"
#include "refusal.h"

namespace landfall {
namespace {

__extension__ typedef __int128 Wide;

// Integers whose determinant needs 104 bits, on one line or beside it by 1.
TEST(Orientation, SignIsThatOfIntegerArithmetic) {
  std::mt19937_64 random(1);
  const auto whole = [&](std::int64_t size) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * size + 1)) - size;
  };
  using Whole = std::array<std::int64_t, 2>;
  const auto point = [](const Whole& v) {
    return Eigen::Vector2d(static_cast<double>(v[0]), static_cast<double>(v[1]));
  };
  int ties = 0;
  for (int i = 0; i < 100000; ++i) {
    const Whole a{whole(1LL << 51), whole(1LL << 51)};
    const Whole step{whole(1LL << 25), whole(1LL << 25)};
    const std::int64_t p = whole(1LL << 25);
    const std::int64_t q = whole(1LL << 25);
    const Whole b{a[0] + p * step[0], a[1] + p * step[1]};
    const Whole c{a[0] + q * step[0] + whole(1), a[1] + q * step[1] + whole(1)};
    const Wide exact = Wide{a[0] - c[0]} * (b[1] - c[1]) - Wide{a[1] - c[1]} * (b[0] - c[0]);
    const double value = orient2d(point(a), point(b), point(c));
    ASSERT_EQ((value > 0) - (value < 0), (exact > 0) - (exact < 0)) << i;
    EXPECT_NEAR(value, static_cast<double>(exact), 1e-6 * std::abs(static_cast<double>(exact)));
    if (exact == 0) ++ties;
  }
  EXPECT_GT(ties, 5000);
}

TEST(TriangleMesh, CubeHasItsTopAndNoLeaks) {
  const TriangleMesh cube(cube_mesh());
  for (double x = -1; x <= 1; x += 0.125)
    for (double y = -1; y <= 1; y += 0.125) EXPECT_EQ(cube.elevation(x, y), 1) << x << ' ' << y;
  const double beyond = std::nextafter(1.0, 2.0);
  for (const double x : {-beyond, beyond, kNan}) {
    EXPECT_TRUE(std::isnan(cube.elevation(x, 0)));
    EXPECT_TRUE(std::isnan(cube.elevation(0, x)));
  }
  EXPECT_FALSE(cube.is_terrain_below());
}

TEST(TriangleMesh, TetrahedronIsAPlane) {
  const TriangleMesh mesh(tetrahedron_mesh());
  for (double x = 0; x <= 1; x += 0.0625)
    for (double y = 0; y <= 1 - x; y += 0.0625) EXPECT_NEAR(mesh.elevation(x, y), 1 - x - y, 1e-15);
  EXPECT_TRUE(std::isnan(mesh.elevation(0.5, 0.5 + 1e-15)));
  const Eigen::Vector3d slope = mesh.normal({0.3, 0.3, 0.4});
  EXPECT_NEAR((slope - Eigen::Vector3d::Constant(std::sqrt(1.0 / 3))).norm(), 0, 1e-15);
  EXPECT_EQ(mesh.normal({0.2, 0.3, 0}), Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(mesh.normal({0, 0.3, 0.4}), Eigen::Vector3d(-1, 0, 0));
}

// A triangle whose edges are at most e long lies at most 1 - sqrt(1 - e^2 / 3) below the sphere.
TEST(TriangleMesh, SphereIsRound) {
  const TriangleMesh mesh(sphere_mesh(5));
  ASSERT_EQ(mesh.triangle_count(), 8U << 10U);
  double longest = 0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh.triangle(i)[k] - mesh.triangle(i)[(k + 1) % 3]).norm());
  const double sag = 1 - std::sqrt(1 - longest * longest / 3);
  for (double x = -0.9; x <= 0.9; x += 0.0437)
    for (double y = -0.4; y <= 0.4; y += 0.0391) {
      const double z = std::sqrt(1 - x * x - y * y);
      const double H = mesh.elevation(x, y);
      EXPECT_LE(H, z + 1e-15);
      EXPECT_GE(H, z - 1.2 * sag / z);
      EXPECT_GT(mesh.normal({x, y, H}).dot(Eigen::Vector3d(x, y, z)), 0.998);
    }
}

TEST(TriangleMesh, HighestSurfaceCountsAndNormalsAreOfThePlace) {
  const TriangleMesh mesh(mushroom_mesh());
  EXPECT_EQ(mesh.elevation(0.5, 0.25), 4);
  EXPECT_EQ(mesh.elevation(-3, 3), 4);
  EXPECT_EQ(mesh.normal({2, 0.5, 3}), Eigen::Vector3d(0, 0, -1));     // under the cap
  EXPECT_EQ(mesh.normal({1, 0.25, 1.5}), Eigen::Vector3d(1, 0, 0));   // on the stem
  EXPECT_EQ(mesh.normal({0.5, -3, 3.5}), Eigen::Vector3d(0, -1, 0));  // on the rim
  EXPECT_EQ(mesh.normal({0.5, 0.25, 4}), Eigen::Vector3d(0, 0, 1));
  EXPECT_TRUE(mesh.normal({kNan, 0, 0}).array().isNaN().all());
}

TEST(TriangleMesh, UprightTrianglesCountWithTheirHighestPoint) {
  const TriangleMesh wall({{{0, 0, 0}, {4, 0, 0}, {0, 0, 2}, {4, 0, -2}}, {{0, 1, 2}, {0, 3, 1}}});
  EXPECT_EQ(wall.elevation(0, 0), 2);
  EXPECT_EQ(wall.elevation(1, 0), 1.5);
  EXPECT_EQ(wall.elevation(4, 0), 0);
  EXPECT_TRUE(std::isnan(wall.elevation(1, 1e-300)));
  EXPECT_TRUE(std::isnan(wall.elevation(-0.5, 0)));
}

// The obvious way: barycentric coordinates in long double, all triangles.
double brute_elevation(const IndexedTriangles& mesh, double x, double y) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto t = mesh.corners(i);
    const auto area = [&](std::size_t p, std::size_t q) {
      const long double px = t[p].x() - static_cast<long double>(x);
      const long double py = t[p].y() - static_cast<long double>(y);
      return px * (t[q].y() - static_cast<long double>(y)) - py * (t[q].x() - static_cast<long double>(x));
    };
    const long double u = area(1, 2);
    const long double v = area(2, 0);
    const long double w = area(0, 1);
    if (std::min({u, v, w}) < 0 && std::max({u, v, w}) > 0) continue;
    highest =
        std::max(highest, static_cast<double>((u * t[0].z() + v * t[1].z() + w * t[2].z()) / (u + v + w)));
  }
  return std::isinf(highest) ? kNan : highest;
}

TEST(TriangleMesh, ElevationIsThatOfAllTriangles) {
  std::mt19937_64 random(2);
  for (const std::size_t count : {1U, 3U, 5U, 17U, 400U, 3000U}) {
    const TriangleMesh mesh(random_mesh(random, count));
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d near = mesh.data().vertices[random() % mesh.data().vertices.size()];
      const double x = near.x() + random_in(random, -0.3, 0.3);
      const double y = near.y() + random_in(random, -0.3, 0.3);
      const double expected = brute_elevation(mesh.data(), x, y);
      const double H = mesh.elevation(x, y);
      ASSERT_EQ(std::isnan(H), std::isnan(expected)) << count;
      if (std::isnan(H)) continue;
      ++hits;
      EXPECT_NEAR(H, expected, 1e-12) << count;
    }
    EXPECT_GT(hits, 0) << count;
  }
}

// The doubles nearest to the exact elevations, as fractions of integers give them; 80 bits gave their
// neighbours.
TEST(TriangleMesh, ElevationIsTheSameOnEveryProcessor) {
  const auto elevation_of = [](const std::array<Eigen::Vector3d, 3>& t, double x, double y) {
    return TriangleMesh({{t.begin(), t.end()}, {{0, 1, 2}}}).elevation(x, y);
  };
  EXPECT_EQ(
      elevation_of({{{-0.193, -0.727, 0.847}, {0.266, -0.573, 0.078}, {-0.947, 0.06, -0.894}}}, -0.29, -0.41),
      -0x1.f1e44b1b24fb5p-13);
  EXPECT_EQ(
      elevation_of({{{-0.778, 0.812, 0.663}, {0.252, 0.262, -0.602}, {-0.305, -0.983, -0.134}}}, -0.28, 0.03),
      -0x1.56c0c6bcc5da9p-6);
}

TEST(TriangleMesh, NormalIsThatOfTheTriangleOfThePlace) {
  std::mt19937_64 random(3);
  const TriangleMesh mesh(random_mesh(random, 2000));
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const auto t = mesh.triangle(i);
    const double u = random_in(random, 0.1, 0.5);
    const double v = random_in(random, 0.1, 0.4);
    const Eigen::Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    EXPECT_GT(mesh.normal(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0])).dot(n), 1 - 1e-9) << i;
  }
}

TEST(TriangleMesh, NoVerticalSlipsBetweenNeighbours) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 20; ++round) {
    const TriangleMesh mesh(rough_sheet(random, 16));
    const IndexedTriangles& data = mesh.data();
    for (const Eigen::Vector3d& v : data.vertices) EXPECT_EQ(mesh.elevation(v.x(), v.y()), v.z());
    for (const TriangleCorners& t : data.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const double part = random_in(random, 0, 1);
        const Eigen::Vector3d p = data.vertices[t[k]];
        const Eigen::Vector3d on_edge = p + part * (data.vertices[t[(k + 1) % 3]] - p);
        if (on_edge.head<2>().cwiseAbs().maxCoeff() > 1) continue;
        EXPECT_NEAR(mesh.elevation(on_edge.x(), on_edge.y()), on_edge.z(), 1e-13);
      }
  }
}

std::string mesh_refusal(const IndexedTriangles& mesh) {
  return refusal<FormatError>([&] { const TriangleMesh built(mesh, "t.h5"); });
}

TEST(TriangleMesh, RefusesWhatIsNotSound) {
  const std::vector<Eigen::Vector3d> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  EXPECT_EQ(mesh_refusal({corners, {}}), "t.h5: the mesh has no triangle");
  EXPECT_EQ(mesh_refusal({corners, {{0, 1, 2}, {0, 1, 4}}}), "t.h5: triangle 1 names vertex 4 of 4");
  EXPECT_EQ(mesh_refusal({corners, {{0, 1, 3}}}), "t.h5: triangle 0 has no area");
  EXPECT_EQ(mesh_refusal({corners, {{0, 1, 1}}}), "t.h5: triangle 0 has no area");
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), 1.1e12, -1.1e12}) {
    std::vector<Eigen::Vector3d> spoilt = corners;
    spoilt[2].y() = bad;
    EXPECT_THAT(mesh_refusal({spoilt, {{0, 1, 2}}}), testing::HasSubstr("t.h5: vertex 2 is not finite, or"));
  }
}

}  // namespace
}  // namespace landfall
