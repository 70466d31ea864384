// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/elevation_pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// 10 x 7 nodes: 9 x 6 cells, 3 x 2 blocks; the elevation is 10 row + col.
Grid<double> ramp() {
  Grid<double> nodes(GridSpec{1, 0, 0, 10, 7});
  for (std::int64_t row = 0; row < 10; ++row)
    for (std::int64_t col = 0; col < 7; ++col) nodes.at({row, col}) = static_cast<double>(10 * row + col);
  return nodes;
}

TEST(ElevationPyramid, BlocksHoldTheNodesOnTheirBorders) {
  const ElevationPyramid pyramid(ramp());
  ASSERT_EQ(pyramid.level_count(), 3);
  const ElevationPyramid::Level& blocks = pyramid.level(0);
  ASSERT_EQ(blocks.rows, 3);
  ASSERT_EQ(blocks.cols, 2);
  EXPECT_EQ(blocks.low[blocks.index({1, 0})], 40);
  EXPECT_EQ(blocks.high[blocks.index({1, 0})], 84);
  EXPECT_EQ(blocks.low[blocks.index({2, 1})], 84);
  EXPECT_EQ(blocks.high[blocks.index({2, 1})], 96);
}

TEST(ElevationPyramid, CoarserLevelsCoverFourBlocks) {
  const ElevationPyramid pyramid(ramp());
  const ElevationPyramid::Level& blocks = pyramid.level(1);
  ASSERT_EQ(blocks.rows, 2);
  ASSERT_EQ(blocks.cols, 1);
  EXPECT_EQ(blocks.high[blocks.index({0, 0})], 86);
  EXPECT_EQ(blocks.low[blocks.index({1, 0})], 80);
  EXPECT_EQ(pyramid.lowest(), 0);
  EXPECT_EQ(pyramid.highest(), 96);
}

TEST(ElevationPyramid, RoundsOutward) {
  Grid<double> nodes(GridSpec{1, 0, 0, 2, 2}, 0.1);
  nodes.at({0, 0}) = -0.1;
  const ElevationPyramid pyramid(nodes);
  EXPECT_LE(double{pyramid.lowest()}, -0.1);
  EXPECT_GE(double{pyramid.highest()}, 0.1);
  EXPECT_NEAR(double{pyramid.highest()}, 0.1, 1e-8);
  nodes.at({1, 1}) = 1e300;
  EXPECT_EQ(ElevationPyramid(nodes).highest(), kInfinity);
}

TEST(ElevationPyramid, HolesCountForNothing) {
  Grid<double> nodes(GridSpec{1, 0, 0, 2, 9}, kNan);
  for (std::int64_t col = 0; col < 4; ++col) nodes.at({0, col}) = 3;
  const ElevationPyramid pyramid(nodes);
  EXPECT_EQ(pyramid.level(0).high[0], 3);
  EXPECT_EQ(pyramid.level(0).low[1], kInfinity);
  EXPECT_EQ(pyramid.level(0).high[1], -kInfinity);
  EXPECT_EQ(pyramid.lowest(), 3);
}

TEST(ElevationPyramid, BoundsOverABox) {
  const ElevationPyramid pyramid(ramp());
  const ElevationPyramid::Bounds one = pyramid.over({1, 2, 1, 2});
  EXPECT_EQ(one.low, 0);
  EXPECT_EQ(one.high, 44);
  const ElevationPyramid::Bounds border =
      pyramid.over({1, 2, 3.99, 3.99});  // the margin reaches the next block
  EXPECT_EQ(border.high, 84);
  const ElevationPyramid::Bounds everything = pyramid.over({-100, 100, -100, 100});
  EXPECT_EQ(everything.low, 0);
  EXPECT_EQ(everything.high, 96);
  const ElevationPyramid::Bounds outside = pyramid.over({20, 21, 1, 2});
  EXPECT_GT(outside.low, outside.high);
}

}  // namespace
}  // namespace landfall
