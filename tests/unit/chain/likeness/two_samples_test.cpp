// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/likeness/two_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "chain/likeness/spacing.h"

namespace landfall {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(TwoSamples, DistanceOfKolmogorovAndSmirnovByHand) {
  // F_0 - F_1 is 1/3 from 1 on, 2/3 - 1/3 from 2 on, 1 - 2/3 from 3 on, and 0 at the end.
  const TwoSamples samples({{3, 0}, {1, 0}, {2, 2}, {4, 1}, {2, 1}, {3, 3}, {kNaN, 0}});
  EXPECT_DOUBLE_EQ(samples.ks_distance(original_sides()), 1.0 / 3);
  Sides exchanged = original_sides();
  std::swap(exchanged[0],
            exchanged[1]);  // 0: 4, 2, 2; 1: 3, 1, 3: 1/3 - 0 at 1, 1/3 - 2/3 at 2, 1 - 2/3 at 3
  EXPECT_DOUBLE_EQ(samples.ks_distance(exchanged), 1.0 / 3);
  EXPECT_DOUBLE_EQ(TwoSamples({{1, 0}, {2, 0}, {3, 1}}).ks_distance(original_sides()), 1);
  EXPECT_EQ(TwoSamples({{1, 0}, {1, 0}, {1, 1}}).ks_distance(original_sides()), 0);
  EXPECT_TRUE(std::isnan(TwoSamples({{1, 0}, {kNaN, 1}}).ks_distance(original_sides())));
}

TEST(TwoClouds, EnergyDistanceByHand) {
  EXPECT_DOUBLE_EQ(TwoClouds({{0, 0, 0, 0}, {0, 3, 4, 1}}).energy_distance(original_sides()), std::sqrt(10));
  // 2 E|X - Y| = 2, E|X - X'| = (0 + 2 + 2 + 0)/4
  EXPECT_DOUBLE_EQ(TwoClouds({{0, 0, 0, 0}, {2, 0, 0, 2}, {1, 0, 0, 1}}).energy_distance(original_sides()),
                   1);
  EXPECT_TRUE(std::isnan(TwoClouds({{0, 0, 0, 0}}).energy_distance(original_sides())));
}

TEST(TwoClouds, EqualCloudsHaveNoDistanceWithAnySides) {
  std::vector<TwoClouds::Position> positions;
  for (std::size_t scan = 0; scan < 2; ++scan)
    for (std::size_t i = 0; i < 400; ++i) {
      const auto x = static_cast<double>(i);
      positions.push_back({x / 7, std::sqrt(x), x * x / 3, block_of(i, 400, scan)});
    }
  const TwoClouds clouds(positions);
  EXPECT_EQ(clouds.energy_distance(original_sides()), 0);
  for (std::uint64_t number = 0; number < 3; ++number)
    EXPECT_EQ(clouds.energy_distance(exchanged_sides(number)), 0);
}

TEST(Blocks, ExchangesMovePairsOfBlocks) {
  std::set<Sides> all;
  double moved = 0;
  for (std::uint64_t number = 0; number < 199; ++number) {
    const Sides sides = exchanged_sides(number);
    for (std::size_t k = 0; k < kLikenessBlocks; ++k) {
      EXPECT_EQ(sides.at(2 * k) + sides.at(2 * k + 1), 1);
      moved += sides.at(2 * k);
    }
    all.insert(sides);
  }
  EXPECT_EQ(all.size(), 199);
  EXPECT_NEAR(moved / (199 * kLikenessBlocks), 0.5, 0.03);  // 5 sigma
}

TEST(Blocks, SamplesAreAscendingAndInTheirStrata) {
  EXPECT_EQ(sample_of(3, 5), (std::vector<std::size_t>{0, 1, 2}));
  const std::vector<std::size_t> sample = sample_of(1000, 10);
  ASSERT_EQ(sample.size(), 10);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(sample[k] / 100, k);
}

TEST(Spacing, AlongAndAcrossTheLinesOfAScan) {
  std::vector<Horizontal> places;  // lines along x, a point per 1 m, every 2.5 m, to and fro
  for (int line = 0; line < 20; ++line)
    for (int i = 0; i < 30; ++i) places.push_back({line % 2 == 0 ? i : 29.0 - i, 2.5 * line});
  for (const double cell_m : {0.5, 7.0}) {
    const Spacings spacings = spacings_of(places, cell_m);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool turns = i % 30 == 29 || i % 30 == 0;
      if (i + 1 < places.size()) {
        EXPECT_DOUBLE_EQ(spacings.along[i], i % 30 == 29 ? 2.5 : 1) << i;
      }
      if (!turns) {
        EXPECT_DOUBLE_EQ(spacings.across[i], 2.5) << i;
      }
    }
    EXPECT_TRUE(std::isnan(spacings.along.back()) && std::isnan(spacings.across.back()));
  }
}

}  // namespace
}  // namespace landfall
