// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/triangulated_grid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "bins.h"
#include "constants.h"

namespace landfall {
namespace {

// 3 x 3 nodes at -1, 0, 1 m.
TriangulatedGrid nine_nodes(std::initializer_list<double> south_to_north) {
  Grid<double> nodes(GridSpec::centered(1, 1));
  std::copy(south_to_north.begin(), south_to_north.end(), nodes.values().begin());
  return TriangulatedGrid(std::move(nodes));
}

TEST(TriangulatedGrid, NeedsTwoByTwo) {
  EXPECT_THROW(TriangulatedGrid(Grid<double>(GridSpec{1, 0, 0, 1, 5})), FormatError);
}

TEST(TriangulatedGrid, ReproducesAPlane) {
  const TriangulatedGrid terrain(
      grid_of(GridSpec::centered(3, 0.5), [](double x, double y) { return 2 + 0.3 * x - 0.7 * y; }));
  for (double x = -3; x <= 3; x += 0.17)
    for (double y = -3; y <= 3; y += 0.19) EXPECT_NEAR(terrain.elevation(x, y), 2 + 0.3 * x - 0.7 * y, 1e-14);
  EXPECT_NEAR(terrain.elevation(3, 3), 2 - 1.2, 1e-14);
}

// One node raised: the diagonal from (col + 1, row) to (col, row + 1) decides the elevation at cell centres.
TEST(TriangulatedGrid, DiagonalRunsFromLowerRightToUpperLeft) {
  const TriangulatedGrid terrain = nine_nodes({0, 0, 0, 0, 1, 0, 0, 0, 0});
  EXPECT_EQ(terrain.elevation(0, 0), 1);
  EXPECT_EQ(terrain.elevation(0.5, 0.5), 0);    // node (0,0) is the cell's lower left: the diagonal avoids it
  EXPECT_EQ(terrain.elevation(-0.5, -0.5), 0);  // upper right corner of its cell, too
  EXPECT_EQ(terrain.elevation(-0.5, 0.5), 0.5);  // lower right corner: on the diagonal
  EXPECT_EQ(terrain.elevation(0.5, -0.5), 0.5);  // upper left corner: on the diagonal
  EXPECT_EQ(terrain.elevation(0.25, 0.25), 0.5);
}

TEST(TriangulatedGrid, OffTheGridIsNan) {
  const TriangulatedGrid terrain = nine_nodes({0, 0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(std::isnan(terrain.elevation(1.0000001, 0)));
  EXPECT_TRUE(std::isnan(terrain.elevation(0, -1.0000001)));
  EXPECT_TRUE(std::isnan(terrain.elevation(kNan, 0)));
}

// A NaN node at the north-east corner removes only the triangle that touches it; the surface is closed.
TEST(TriangulatedGrid, HoleIsATriangle) {
  const TriangulatedGrid terrain = nine_nodes({1, 1, 1, 1, 1, 1, 1, 1, kNan});
  EXPECT_EQ(terrain.elevation(0.25, 0.25), 1);
  EXPECT_EQ(terrain.elevation(0.5, 0.5), 1);  // on the diagonal: the lower triangle closes it
  EXPECT_TRUE(std::isnan(terrain.elevation(0.75, 0.75)));
  EXPECT_TRUE(std::isnan(terrain.elevation(1, 1)));
}

// All four cells around the centre node lose a triangle or two when it is NaN; borders of what remains still
// count.
TEST(TriangulatedGrid, BordersOfAHoleBelongToTheirNeighbours) {
  const TriangulatedGrid terrain = nine_nodes({1, 1, 1, 1, kNan, 1, 1, 1, 1});
  EXPECT_TRUE(std::isnan(terrain.elevation(0, 0)));
  EXPECT_TRUE(std::isnan(terrain.elevation(0.2, 0.2)));
  EXPECT_EQ(terrain.elevation(0.7, 0.7), 1);
  EXPECT_EQ(terrain.elevation(0, 1), 1);
  EXPECT_EQ(terrain.elevation(-1, -1), 1);
}

// Against each triangle's own normal, (-g_x, -g_y, 1).
TEST(TriangulatedGrid, GradientIsThatOfTheTriangle) {
  const TriangulatedGrid terrain = nine_nodes({0, 1, 5, -3, 4, 2, 6, 1, 8});
  for (std::size_t id = 0; id < 8; ++id) {
    const auto corners = terrain.triangle(id);
    const Eigen::Vector3d centroid = (corners[0] + corners[1] + corners[2]) / 3;
    const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const Eigen::Vector2d gradient = terrain.gradient(centroid.x(), centroid.y());
    EXPECT_LT((gradient + normal.head<2>() / normal.z()).norm(), 1e-14) << id;
  }
}

TEST(TriangulatedGrid, GradientOffTheGridIsTheNearestCells) {
  const TriangulatedGrid terrain = nine_nodes({0, 1, 5, -3, 4, 2, 6, 1, 8});
  EXPECT_EQ(terrain.gradient(1 + 1e-12, 0.9), terrain.gradient(0.99, 0.9));
  EXPECT_EQ(terrain.gradient(-0.9, -1 - 1e-12), terrain.gradient(-0.9, -0.99));
  const TriangulatedGrid hole = nine_nodes({1, 1, 1, 1, 1, 1, 1, 1, kNan});
  EXPECT_TRUE(std::isnan(hole.gradient(0.75, 0.75).x()));
  EXPECT_EQ(hole.gradient(0.25, 0.25), Eigen::Vector2d(0, 0));
}

TEST(TriangulatedGrid, TrianglesAreTheSurface) {
  const TriangulatedGrid terrain = nine_nodes({0, 1, 2, 3, 4, 5, 6, 7, 8});
  ASSERT_EQ(terrain.triangle_count(), 8U);
  for (std::size_t id = 0; id < 8; ++id) {
    const auto corners = terrain.triangle(id);
    const Eigen::Vector3d centroid = (corners[0] + corners[1] + corners[2]) / 3;
    EXPECT_NEAR(terrain.elevation(centroid.x(), centroid.y()), centroid.z(), 1e-14);
    EXPECT_GT((corners[1] - corners[0]).cross(corners[2] - corners[0]).z(), 0);
  }
}

TEST(TriangulatedGrid, CosinesOfManyPointsAreThoseOfEach) {
  constexpr GridSpec kSpec{0.5, -4, -4, 9, 9};
  Grid<double> nodes(kSpec);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (double& z : nodes.values()) z = uniform(random);
  nodes.at({4, 5}) = std::numeric_limits<double>::quiet_NaN();
  for (const CellOrigin& origin : {CellOrigin(), CellOrigin::of_windows(kSpec, 1)}) {
    const TriangulatedGrid grid(nodes, origin);
    std::vector<Eigen::Vector3d> points;
    std::vector<Eigen::Vector3d> directions;
    std::size_t holes = 0;
    for (int i = 0; i < 1003; ++i) {  // also on nodes and edges, and off the grid
      Eigen::Vector3d point(2.5 * uniform(random), 2.5 * uniform(random), 0);
      if (i % 3 == 0) point.x() = 0.5 * std::round(2 * point.x());
      if (i % 6 == 0) point.y() = 0.5 * std::round(2 * point.y());
      points.push_back(point);
      directions.push_back(Eigen::Vector3d(uniform(random), uniform(random), uniform(random)).normalized());
    }
    std::vector<double> cosines(points.size());
    grid.cosines(points, directions, cosines);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double expected = std::abs(grid.normal(points[i]).dot(directions[i]));
      ASSERT_EQ(std::isnan(cosines[i]), std::isnan(expected)) << points[i];
      if (std::isnan(expected)) {
        ++holes;
      } else {
        EXPECT_NEAR(cosines[i], expected, 1e-15) << points[i];
      }
    }
    EXPECT_GT(holes, 10U);
  }
}

}  // namespace
}  // namespace landfall
