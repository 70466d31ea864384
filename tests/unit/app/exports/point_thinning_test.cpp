// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/point_thinning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/numerics/random.h"

namespace landfall {
namespace {

std::vector<PointPlace> random_places(std::size_t count, std::uint64_t seed) {
  const RandomField random(seed, RandomStream::range_noise);
  std::vector<double> draws(2 * count);
  random.normals_along_i(0, 0, draws);
  std::vector<PointPlace> places;
  for (std::size_t i = 0; i < count; ++i) places.push_back({10 * draws[2 * i], 10 * draws[2 * i + 1]});
  return places;
}

constexpr PointPlace kLow = {-80, -80};
constexpr PointPlace kHigh = {80, 80};

ThinnedPoints thinned(const std::vector<PointPlace>& places, std::size_t maximum, double cell_m = 0.01) {
  PointThinning thinning(kLow, kHigh, cell_m, maximum);
  for (std::size_t i = 0; i < places.size(); ++i) thinning.add(places[i], 2 * i);
  return thinning.finish();
}

TEST(PointThinning, KeepsAllOfFewPoints) {
  const ThinnedPoints all = thinned({{0, 0}, {0, 0}, {1, 2}}, 3);
  EXPECT_THAT(all.rows, testing::ElementsAre(0, 2, 4));
  EXPECT_EQ(all.cell_m, 0);
}

TEST(PointThinning, KeepsOnePointOfEachSquare) {
  const std::vector<PointPlace> places = random_places(60000, 1);
  const ThinnedPoints some = thinned(places, 3000);
  EXPECT_LE(some.rows.size(), 3000U);
  EXPECT_GT(some.rows.size(), 2500U);
  ASSERT_GT(some.cell_m, 0);
  std::map<std::array<int, 2>, int> cells;
  for (const std::uint64_t row : some.rows) {
    std::array<int, 2> cell{};
    for (std::size_t axis = 0; axis < 2; ++axis)
      cell[axis] = static_cast<int>(std::floor((places[row / 2][axis] - kLow[axis]) / some.cell_m));
    ++cells[cell];
  }
  // rounding to 2^-32 of the extent may move a point on an edge to the next square
  EXPECT_GE(cells.size() + 2, some.rows.size());
  EXPECT_TRUE(std::ranges::is_sorted(some.rows));
}

TEST(PointThinning, KeepsLonelyPointsAmongMany) {
  std::vector<PointPlace> places = random_places(60000, 2);
  places.insert(places.begin() + 30000, {70, -70});
  const ThinnedPoints some = thinned(places, 1000);
  EXPECT_THAT(some.rows, testing::Contains(60000));
}

TEST(PointThinning, ChoosesAtRandomInASquare) {
  // 30 points in each square of a regular grid; the mean number of the chosen ones is 14.5 +- 0.07
  std::vector<PointPlace> places;
  for (int square = 0; square < 16384; ++square)
    for (int i = 0; i < 30; ++i)
      places.push_back({-79.5 + 1.25 * (square % 128), -79.5 + 1.25 * (square / 128)});
  const ThinnedPoints some = thinned(places, 16384);
  ASSERT_EQ(some.rows.size(), 16384U);
  double sum = 0;
  for (const std::uint64_t row : some.rows) sum += static_cast<double>(row / 2 % 30);
  EXPECT_NEAR(sum / 16384, 14.5, 0.28);
}

TEST(PointThinning, TheFirstSquaresMayBeTooSmall) {
  const std::vector<PointPlace> places = random_places(30000, 3);
  const ThinnedPoints some = thinned(places, 500, 1e-9);
  EXPECT_LE(some.rows.size(), 500U);
  EXPECT_GT(some.rows.size(), 400U);
}

TEST(PointThinning, PointsAtOnePlace) {
  PointThinning thinning({5, 5}, {5, 5}, 1, 10);
  for (std::uint64_t row = 0; row < 100; ++row) thinning.add({5, 5}, row);
  EXPECT_THAT(thinning.finish().rows, testing::SizeIs(1));
}

}  // namespace
}  // namespace landfall
