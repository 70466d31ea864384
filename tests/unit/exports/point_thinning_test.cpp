// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/point_thinning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/random.h"

namespace landfall {
namespace {

std::vector<PointPlace> random_places(std::size_t count, std::uint64_t seed) {
  const RandomField random(seed, RandomStream::range_noise);
  std::vector<double> draws(3 * count);
  random.normals_along_i(0, 0, draws);
  std::vector<PointPlace> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back({10 * draws[3 * i], 10 * draws[3 * i + 1], draws[3 * i + 2]});
  return places;
}

constexpr PointPlace kLow = {-80, -80, -80};
constexpr PointPlace kHigh = {80, 80, 80};

ThinnedPoints thinned(const std::vector<PointPlace>& places, std::size_t most, double cell_m = 0.01) {
  PointThinning thinning(kLow, kHigh, cell_m, most);
  for (std::size_t i = 0; i < places.size(); ++i) thinning.add(places[i], 2 * i);
  return thinning.finish();
}

TEST(PointThinning, KeepsAllOfFewPoints) {
  const ThinnedPoints all = thinned({{0, 0, 0}, {0, 0, 0}, {1, 2, 3}}, 3);
  EXPECT_THAT(all.rows, testing::ElementsAre(0, 2, 4));
  EXPECT_EQ(all.cell_m, 0);
}

TEST(PointThinning, KeepsOnePointOfEachCube) {
  const std::vector<PointPlace> places = random_places(60000, 1);
  const ThinnedPoints some = thinned(places, 3000);
  EXPECT_LE(some.rows.size(), 3000U);
  EXPECT_GT(some.rows.size(), 2500U);
  ASSERT_GT(some.cell_m, 0);
  std::map<std::array<int, 3>, int> cells;
  for (const std::uint64_t row : some.rows) {
    std::array<int, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<int>(std::floor((places[row / 2][axis] - kLow[axis]) / some.cell_m));
    ++cells[cell];
  }
  // rounding to 2^-32 of the extent may move a point on a face to the next cube
  EXPECT_GE(cells.size() + 2, some.rows.size());
  EXPECT_TRUE(std::ranges::is_sorted(some.rows));
}

TEST(PointThinning, KeepsLonelyPointsAmongMany) {
  std::vector<PointPlace> places = random_places(60000, 2);
  places.insert(places.begin() + 30000, {70, -70, 60});
  const ThinnedPoints some = thinned(places, 1000);
  EXPECT_THAT(some.rows, testing::Contains(60000));
}

TEST(PointThinning, TakesThePointNearestToTheMiddleOfItsCube) {
  std::vector<PointPlace> places(500, {-79.9, -79.9, -79.9});
  places[321] = {0.1, 0.2, -0.1};  // the middle of the only cube
  const ThinnedPoints one = thinned(places, 1);
  EXPECT_THAT(one.rows, testing::ElementsAre(642));
}

TEST(PointThinning, TheFirstCubesMayBeTooSmall) {
  const std::vector<PointPlace> places = random_places(30000, 3);
  const ThinnedPoints some = thinned(places, 500, 1e-9);
  EXPECT_LE(some.rows.size(), 500U);
  EXPECT_GT(some.rows.size(), 400U);
}

TEST(PointThinning, PointsAtOnePlace) {
  PointThinning thinning({5, 5, 5}, {5, 5, 5}, 1, 10);
  for (std::uint64_t row = 0; row < 100; ++row) thinning.add({5, 5, 5}, row);
  EXPECT_THAT(thinning.finish().rows, testing::ElementsAre(0));
}

}  // namespace
}  // namespace landfall
