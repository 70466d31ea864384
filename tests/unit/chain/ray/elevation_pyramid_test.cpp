// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/ray/elevation_pyramid.h"

#include <gtest/gtest.h>

#include <limits>

#include "constants.h"

namespace landfall {
namespace {

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

// 10 x 7 nodes: 9 x 6 cells, 3 x 2 blocks; the elevation is 10 row + col.
Grid<double> ramp() {
  Grid<double> nodes(GridSpec{1, 0, 0, 10, 7});
  for (std::int64_t row = 0; row < 10; ++row)
    for (std::int64_t col = 0; col < 7; ++col) nodes.at({row, col}) = static_cast<double>(10 * row + col);
  return nodes;
}

TEST(ElevationPyramid, CellsHoldTheirFourNodes) {
  const ElevationPyramid pyramid(ramp());
  ASSERT_EQ(pyramid.level(0).rows, 9);
  ASSERT_EQ(pyramid.level(0).cols, 6);
  EXPECT_EQ(pyramid.bounds(0, {0, 0}).low, 0);
  EXPECT_EQ(pyramid.bounds(0, {0, 0}).high, 11);
  EXPECT_EQ(pyramid.bounds(0, {8, 5}).low, 85);
  EXPECT_EQ(pyramid.bounds(0, {8, 5}).high, 96);
}

TEST(ElevationPyramid, BlocksHoldTheNodesOnTheirBorders) {
  const ElevationPyramid pyramid(ramp());
  ASSERT_EQ(pyramid.level_count(), 4);
  ASSERT_EQ(pyramid.level(1).rows, 3);
  ASSERT_EQ(pyramid.level(1).cols, 2);
  EXPECT_EQ(pyramid.bounds(1, {1, 0}).low, 40);
  EXPECT_EQ(pyramid.bounds(1, {1, 0}).high, 84);
  EXPECT_EQ(pyramid.bounds(1, {2, 1}).low, 84);
  EXPECT_EQ(pyramid.bounds(1, {2, 1}).high, 96);
}

TEST(ElevationPyramid, CoarserLevelsCoverFourBlocks) {
  const ElevationPyramid pyramid(ramp());
  ASSERT_EQ(pyramid.level(2).rows, 2);
  ASSERT_EQ(pyramid.level(2).cols, 1);
  EXPECT_EQ(pyramid.bounds(2, {0, 0}).high, 86);
  EXPECT_EQ(pyramid.bounds(2, {1, 0}).low, 80);
  EXPECT_EQ(pyramid.lowest(), 0);
  EXPECT_EQ(pyramid.highest(), 96);
}

// These are what the walk in lanes reads.
TEST(ElevationPyramid, LowsFollowHighs) {
  const ElevationPyramid pyramid(ramp());
  const std::size_t block = pyramid.level(1).index({1, 0});
  EXPECT_EQ(pyramid.lows()[block], 40);
  EXPECT_EQ(pyramid.highs()[block], 84);
  EXPECT_EQ(pyramid.lows().data(), pyramid.highs().data() + pyramid.highs().size());
}

TEST(ElevationPyramid, RoundsOutward) {
  Grid<double> nodes(GridSpec{1, 0, 0, 2, 2}, 0.1);
  nodes.at({0, 0}) = -0.1;
  const ElevationPyramid pyramid(nodes);
  EXPECT_LE(double{pyramid.lowest()}, -0.1);
  EXPECT_GE(double{pyramid.highest()}, 0.1);
  EXPECT_NEAR(double{pyramid.highest()}, 0.1, 1e-8);
  nodes.at({1, 1}) = 1e300;
  EXPECT_EQ(ElevationPyramid(nodes).highest(), kFloatInfinity);
}

TEST(ElevationPyramid, HolesCountForNothing) {
  Grid<double> nodes(GridSpec{1, 0, 0, 2, 9}, kNan);
  for (std::int64_t col = 0; col < 4; ++col) nodes.at({0, col}) = 3;
  const ElevationPyramid pyramid(nodes);
  EXPECT_EQ(pyramid.bounds(1, {0, 0}).high, 3);
  EXPECT_EQ(pyramid.bounds(1, {0, 1}).low, kFloatInfinity);
  EXPECT_EQ(pyramid.bounds(1, {0, 1}).high, -kFloatInfinity);
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
