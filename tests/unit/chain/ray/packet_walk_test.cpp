// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "bins.h"
#include "chain/ray/elevation_pyramid.h"
#include "chain/ray/flat_terrain.h"
#include "chain/ray/packet_walk.h"
#include "constants.h"
#include "scenes.h"
#include "targets.h"

namespace landfall {
namespace {

// The lanes answer what PyramidTraversal answers, to the last bit, on every instruction set that the machine
// has.
/// A pulse of 18 x 18 rays through a cone of half_angle_rad about `boresight`.
std::vector<Ray> pulse(const Ray& boresight, double half_angle_rad) {
  const Eigen::Vector3d right = boresight.direction.v.unitOrthogonal();
  const Eigen::Vector3d down = boresight.direction.v.cross(right);
  std::vector<Ray> rays;
  for (int row = 0; row < 18; ++row)
    for (int col = 0; col < 18; ++col)
      rays.push_back(ray_from(
          boresight.origin.v,
          boresight.direction.v + half_angle_rad * ((col - 8.5) / 9 * right + (row - 8.5) / 9 * down)));
  return rays;
}

class PacketWalk : public SceneTest {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  /// How many of the rays the lanes decide; each of those must be PyramidTraversal's answer.
  static std::size_t decided(const Heightfield& field, const std::vector<Ray>& rays) {
    std::vector<double> ranges(rays.size());
    walk_packets(field, rays, ranges);
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (ranges[i] == kUndecided) continue;
      ++count;
      const double expected = PyramidTraversal(field, rays[i]).first_hit();
      const bool same = std::isnan(expected) ? std::isnan(ranges[i])
                                             : std::bit_cast<std::uint64_t>(expected) ==
                                                   std::bit_cast<std::uint64_t>(ranges[i]);
      EXPECT_TRUE(same) << "ray " << i << ": " << ranges[i] << ", PyramidTraversal " << expected;
    }
    return count;
  }

  /// Fails unless each instruction set answers as PyramidTraversal and decides at least `share` of the rays.
  void expect_descents_answers(const std::vector<Ray>& rays, double share) const {
    const Heightfield field(*terrain_);
    on_every_target([&] {
      EXPECT_GE(static_cast<double>(decided(field, rays)), share * static_cast<double>(rays.size()));
    });
  }
};

INSTANTIATE_TEST_SUITE_P(Scenes, PacketWalk, every_scene(), scene_name);

TEST_P(PacketWalk, PulsesFromAfar) {
  std::vector<Ray> rays;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d origin = Eigen::Vector3d(0, 0, 200) + random_offset(80);
    const std::vector<Ray> more = pulse(ray_at(origin, random_target()), 1e-3);
    rays.insert(rays.end(), more.begin(), more.end());
  }
  expect_descents_answers(rays, 0.95);
}

TEST_P(PacketWalk, SpansOfAnyLength) {
  const Ray boresight = ray_at(Eigen::Vector3d(7, -3, 200), random_target());
  const std::vector<Ray> rays = pulse(boresight, 1e-3);
  for (const std::size_t length : {0U, 1U, 4U, 17U, 63U, 64U, 65U, 129U, 200U})
    expect_descents_answers({rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(length)}, 0);
}

TEST_P(PacketWalk, RaysThatShareNothing) {
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i) rays.push_back(ray_at(random_target() + random_offset(4), random_target()));
  expect_descents_answers(rays, 0.05);
}

// The bound of the steep rays of a group says nothing about those too flat to bound.
TEST_P(PacketWalk, FlatRaysAmongSteepOnes) {
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d target = random_target();
    const double slope = i % 8 == 0 ? std::pow(10, uniform(random_, -18, -1)) : 1;
    rays.push_back(ray_at(target + Eigen::Vector3d(3, 2, 4 * slope), target));
  }
  expect_descents_answers(rays, 0.1);
}

TEST_P(PacketWalk, StraightDown) {
  std::vector<Ray> rays;
  for (int i = 0; i < 5000; ++i)
    rays.push_back(ray_from(random_target() + Eigen::Vector3d(0, 0, 30), {0, 0, -1}));
  expect_descents_answers(rays, 0.99);
}

// A ray that leaves the grid at a node of its border, out of a cell that is a hole, touches the next cell
// there.
TEST_P(PacketWalk, ToNodesOfTheBorder) {
  const GridSpec& spec = terrain_->nodes().spec();
  std::vector<Ray> rays;
  for (int i = 0; i < 40000; ++i) {
    const auto across = static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(spec.cols));
    const auto along = static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(spec.rows));
    const std::array<BinIndex, 4> sides = {
        {{0, across}, {spec.rows - 1, across}, {along, 0}, {along, spec.cols - 1}}};
    const BinIndex node = sides[random_() % 4];
    const double z = terrain_->nodes().at(node);
    if (std::isnan(z)) continue;
    const Eigen::Vector3d target(spec.x(node.col), spec.y(node.row), z);
    rays.push_back(ray_at(target + Eigen::Vector3d(0, 0, 40) + random_offset(10), target));
  }
  expect_descents_answers(rays, 0);
}

TEST_P(PacketWalk, UpwardLevelAndOverTheSide) {
  std::vector<Ray> rays;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d target = random_target();
    const Eigen::Vector3d side = random_offset(30);
    rays.push_back(ray_at(target - Eigen::Vector3d(0.3, 0.2, 30), target));
    rays.push_back(ray_at(target + Eigen::Vector3d(side.x(), side.y(), 0), target));
    rays.push_back(ray_at(target + Eigen::Vector3d(side.x(), side.y(), 0.1 * side.z()), target));
  }
  expect_descents_answers(rays, 0.6);
}

constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

// 10 x 7 nodes: 9 x 6 cells, 3 x 2 blocks; the elevation is 10 row + col.
Grid<double> ramp() {
  Grid<double> nodes(GridSpec{1, 0, 0, 10, 7});
  for (const auto [row, col] : Bins({0, 0}, {10, 7}))
    nodes.at({row, col}) = static_cast<double>(10 * row + col);
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

double range_to(double elevation_m, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const std::array<Ray, 1> rays = {Ray{{origin}, {direction}}};
  std::array<double, 1> ranges{};
  FlatTerrain(elevation_m).first_hits(rays, ranges);
  return ranges[0];
}

TEST(FlatTerrain, RangesAreClosedForm) {
  EXPECT_EQ(range_to(0, {1, 2, 500}, {0, 0, -1}), 500);
  EXPECT_EQ(range_to(7, {1, 2, 500}, {0.6, 0, -0.8}), 493 / 0.8);
  EXPECT_EQ(range_to(0, {0, 0, -4}, {0, 0.6, 0.8}), 5);  // from below
  EXPECT_EQ(range_to(3, {0, 0, 3}, {0, 0, -1}), 0);
}

TEST(FlatTerrain, AwayFromItAndAlongItMiss) {
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, 500}, {0, 0, 1})));
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, 500}, {1, 0, 0})));
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, -5}, {1, 0, 0})));
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, 0}, {1, 0, 0})));
}

}  // namespace
}  // namespace landfall
