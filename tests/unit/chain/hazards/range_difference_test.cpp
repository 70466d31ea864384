// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/numerics/random.h"
#include "bins.h"
#include "brute_force.h"
#include "chain/hazards/measures.h"

namespace landfall {
namespace {

using testing_hazards::random_map;

const GridSpec kSpec{.resolution_m = 0.1, .first_row = -20, .first_col = -20, .rows = 41, .cols = 41};
constexpr RangeWindows kWindows{.lander_half_bins = 4, .rock_half_bins = 2};
constexpr BinIndex kCentre{20, 20};

Grid<double> terrain(const auto& height) { return grid_of(kSpec, height); }

PlaceMeasures measured(const Grid<double>& z, const RangeWindows& windows = kWindows) {
  return measure_range_difference(z, windows, BinMask(z.spec(), 1));
}

TEST(RangeDifference, APlaneAlongAnAxisHasItsSlope) {
  const PlaceMeasures found = measured(terrain([](double x, double) { return 0.2 * x + 7; }));
  EXPECT_NEAR(found.slope_deg.at(kCentre), std::atan(0.2) * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(found.roughness_m.at(kCentre), 0.2 * 0.4, 1e-12);  // over the rock's window
}

TEST(RangeDifference, ADiagonalPlaneIsSteeperByTheRootOfTwo) {
  const PlaceMeasures found = measured(terrain([](double x, double y) { return 0.1 * (x - y); }));
  EXPECT_NEAR(std::tan(found.slope_deg.at(kCentre) * std::numbers::pi / 180), 0.1 * 2, 1e-12);
}

TEST(RangeDifference, AHemisphereHasItsHeightWhereItsWindowReaches) {
  const PlaceMeasures found =
      measured(terrain([](double x, double y) { return std::sqrt(std::max(0.0, 0.09 - x * x - y * y)); }),
               {.lander_half_bins = 4, .rock_half_bins = 4});
  // The median of the top and its neighbours is the height of the four next to it but one.
  const double top_m = std::sqrt(0.09 - 0.01);
  EXPECT_NEAR(found.roughness_m.at(kCentre), top_m, 1e-12);
  EXPECT_NEAR(found.roughness_m.at({kCentre.row, kCentre.col + 8}), top_m,
              1e-12);  // the rock's window at + 4
}

TEST(RangeDifference, AStepIsBothSteepAndRough) {
  const PlaceMeasures found = measured(terrain([](double x, double) { return x > 0 ? 0.5 : 0; }));
  EXPECT_EQ(found.roughness_m.at(kCentre), 0.5);
  EXPECT_NEAR(found.slope_deg.at(kCentre), std::atan(0.5 / 0.8) * 180 / std::numbers::pi, 1e-9);
  EXPECT_EQ(found.roughness_m.at({20, 27}), 0);  // the windows reach 6 bins
  EXPECT_EQ(found.roughness_m.at({20, 26}), 0.5);
}

TEST(RangeDifference, GroupsOfFourBinsAreFiltered) {
  Grid<double> z = terrain([](double, double) { return 0; });
  z.at({20, 20}) = z.at({20, 21}) = z.at({21, 20}) = z.at({21, 21}) = 9;
  EXPECT_EQ(measured(z).roughness_m.at(kCentre), 0);
  z.at({19, 20}) = 9;
  EXPECT_EQ(measured(z).roughness_m.at(kCentre), 9);
}

/// The definitions, window by window.
struct SlowRangeDifference {
  const Grid<double>& z;
  RangeWindows windows;

  [[nodiscard]] double median(BinIndex bin) const {
    std::vector<double> near;
    for (const BinIndex each : Bins({bin.row - 1, bin.col - 1}, {bin.row + 2, bin.col + 2}))
      near.push_back(z.at(each));
    std::ranges::sort(near);
    return near[4];
  }
  [[nodiscard]] double range(BinIndex centre, std::int64_t half) const {
    double minimum = std::numeric_limits<double>::infinity();
    double largest = -minimum;
    for (const auto [row, col] :
         Bins({centre.row - half, centre.col - half}, {centre.row + half + 1, centre.col + half + 1})) {
      minimum = std::min(minimum, median({row, col}));
      largest = std::max(largest, median({row, col}));
    }
    return largest - minimum;
  }
  [[nodiscard]] bool is_known(BinIndex place) const {
    const std::int64_t reach = windows.lander_half_bins + windows.rock_half_bins + 1;
    for (const BinIndex bin :
         Bins({place.row - reach, place.col - reach}, {place.row + reach + 1, place.col + reach + 1}))
      if (!z.spec().contains(bin) || std::isnan(z.at(bin))) return false;
    return true;
  }
  [[nodiscard]] double roughness(BinIndex place) const {
    double maximum = 0;
    for (const auto [row, col] : Bins({-windows.lander_half_bins, -windows.lander_half_bins},
                                      {windows.lander_half_bins + 1, windows.lander_half_bins + 1}))
      maximum = std::max(maximum, range({place.row + row, place.col + col}, windows.rock_half_bins));
    return maximum;
  }
  [[nodiscard]] double slope_deg(BinIndex place) const {
    const double width = 2 * static_cast<double>(windows.lander_half_bins) * z.spec().resolution_m;
    return std::atan2(range(place, windows.lander_half_bins), width) * 180 / std::numbers::pi;
  }
};

TEST(RangeDifference, EqualsItsDefinitionOnRandomMaps) {
  int known = 0;
  int unknown = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    const RangeWindows windows{1 + static_cast<std::int64_t>(4 * field.uniform(1)),
                               1 + static_cast<std::int64_t>(3 * field.uniform(2))};
    const Grid<double> z = random_map({0.1, -9, -8, 19, 26}, seed, seed % 2 == 0 ? 0 : 0.004);
    const PlaceMeasures found = measured(z, windows);
    const SlowRangeDifference slow{z, windows};
    for (const BinIndex place : bins_of(z.spec())) {
      ASSERT_EQ(std::isnan(found.slope_deg.at(place)), !slow.is_known(place));
      ASSERT_EQ(std::isnan(found.roughness_m.at(place)), !slow.is_known(place));
      ++(slow.is_known(place) ? known : unknown);
      if (!slow.is_known(place)) continue;
      ASSERT_NEAR(found.slope_deg.at(place), slow.slope_deg(place), 1e-9);
      ASSERT_NEAR(found.roughness_m.at(place), slow.roughness(place), 1e-9);
    }
  }
  EXPECT_GT(known, 1000);
  EXPECT_GT(unknown, 1000);
}

TEST(RangeDifference, TheSameAtAnyNumberOfThreads) {
  const Grid<double> z = random_map({0.1, -30, -30, 61, 61}, 9, 0);
  testing_hazards::expect_same_at_any_threads([&] { return measured(z); });
}

TEST(RangeDifference, HalfOfTheRocksWindow) {
  EXPECT_EQ(rock_half_bins(0.3, 0.05), 6);
  EXPECT_EQ(rock_half_bins(0.1, 0.1), 1);
  EXPECT_EQ(rock_half_bins(0.099, 0.1), 0);
}

}  // namespace
}  // namespace landfall
