// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/sites.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/numerics/random.h"

namespace landfall {
namespace {

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

TEST(Touchdown, SmoothingOfOneSafeBinIsTheKernel) {
  const GridSpec spec = GridSpec::centered(2, 0.1);
  Grid<float> p(spec);
  p.at(spec.bin_of(0, 0)) = 1;
  const Grid<float> smooth = touchdown_probability(p, 0.25, BinMask(spec, 1));
  double norm = 0;
  for (int k = -7; k <= 7; ++k) norm += std::exp(-std::pow(k * 0.1 / 0.25, 2) / 2);
  double sum = 0;
  for (const float value : smooth.values()) sum += value;
  EXPECT_NEAR(sum, 1, 1e-5);
  const auto at = [&](double x, double y) { return smooth.at(spec.bin_of(x, y)); };
  EXPECT_NEAR(at(0, 0), 1 / (norm * norm), 1e-7);
  EXPECT_NEAR(at(0.3, -0.5), std::exp(-(0.09 + 0.25) / (2 * 0.0625)) / (norm * norm), 1e-7);
  EXPECT_EQ(at(0.8, 0), 0);  // beyond 3 sigma
}

TEST(Touchdown, WhatIsUnknownOrOffTheMapCountsAsUnsafe) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<float> p(spec, 1);
  p.at(spec.bin_of(0.5, 0)) = kFloatNan;
  BinMask region(spec, 1);
  region.at(spec.bin_of(-0.5, 0)) = 0;
  const Grid<float> smooth = touchdown_probability(p, 0.1, region);
  EXPECT_NEAR(smooth.at(spec.bin_of(0, -0.4)), 1, 1e-6);
  EXPECT_LT(smooth.at(spec.bin_of(0.4, 0)), 0.95);
  EXPECT_NEAR(smooth.at({0, 0}), std::pow((1 + smooth.at(spec.bin_of(0, -1)) * 2 - 1) / 2, 2), 1e-6);
  EXPECT_TRUE(std::isnan(smooth.at(spec.bin_of(-0.5, 0))));
  EXPECT_EQ(touchdown_probability(p, 0, region).at(spec.bin_of(0, 0)), 1);
  EXPECT_EQ(touchdown_probability(p, 0, region).at(spec.bin_of(0.5, 0)), 0);
}

TEST(Touchdown, TheKernelReachesThreeSigma) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<float> p(spec);
  p.at(spec.bin_of(0, 0)) = 1;
  const Grid<float> smooth = touchdown_probability(p, 0.1, BinMask(spec, 1));
  EXPECT_GT(smooth.at(spec.bin_of(0.3, 0)), 0.001);
  EXPECT_GT(smooth.at(spec.bin_of(0, -0.3)), 0.001);
  EXPECT_EQ(smooth.at(spec.bin_of(0.4, 0)), 0);
}

TEST(LandingCost, OfTheWholeMap) {
  const Grid<float> cost = landing_cost(Grid<float>(GridSpec::centered(2, 1), 0.75F), {.divert_radius_m = 3});
  for (const float value : cost.values()) EXPECT_GE(value, 0.25F);
}

TEST(LandingCost, GrowsWithTheDivert) {
  const GridSpec spec = GridSpec::centered(5, 1);
  const Grid<float> cost =
      landing_cost(Grid<float>(spec, 0.75F), {.divert_radius_m = 4, .divert_weight = 0.2});
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, 0)), 0.25F);
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, -4)), 0.45F);
  EXPECT_TRUE(std::isnan(cost.at(spec.bin_of(3, 3))));
}

TEST(LandingCost, OfAReachIsNanOutsideItAndKeepsItsScale) {
  const GridSpec spec = GridSpec::centered(5, 1);
  const Grid<float> cost = landing_cost(
      Grid<float>(spec, 0.75F), {.divert_radius_m = 4,
                                 .divert_weight = 0.2,
                                 .reach = ReachableArea::polygon({{-1, -5}, {5, -5}, {5, 0}, {-1, 0}})});
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, -4)), 0.45F);
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(3, -4)), 0.5F);  // beyond divert_radius_m
  EXPECT_FLOAT_EQ(cost.at(spec.bin_of(0, 0)), 0.25F);
  EXPECT_TRUE(std::isnan(cost.at(spec.bin_of(0, 1))));
  EXPECT_TRUE(std::isnan(cost.at(spec.bin_of(-2, -1))));
}

TEST(DistanceToHazard, IsEuclideanAndInTheRegion) {
  const GridSpec spec = GridSpec::centered(5, 0.5);
  Grid<std::int8_t> safe(spec, 1);
  BinMask region(spec, 1);
  EXPECT_TRUE(std::isnan(distance_to_hazard(safe, region).at({0, 0})));
  safe.at(spec.bin_of(0, 0)) = 2;
  safe.at(spec.bin_of(3, 4)) = 0;
  region.at(spec.bin_of(3, 4)) = 0;
  const Grid<float> distance = distance_to_hazard(safe, region);
  EXPECT_EQ(distance.at(spec.bin_of(0, 0)), 0);
  EXPECT_FLOAT_EQ(distance.at(spec.bin_of(4, 3)), 5);
  EXPECT_FLOAT_EQ(distance.at({0, 0}), std::hypot(5.0F, 5.0F));
  EXPECT_TRUE(std::isnan(distance.at(spec.bin_of(3, 4))));
  safe.at({0, 0}) = 0;
  EXPECT_EQ(distance_to_hazard(safe, region).at({0, 0}), 0);
}

TEST(Sites, AreTheBestThatLieApart) {
  const GridSpec spec = GridSpec::centered(10, 1);
  const RandomField field(3, RandomStream::dropout);
  Grid<float> cost(spec);
  Grid<std::int8_t> safe(spec, 1);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    cost.values()[i] = static_cast<float>(std::floor(8 * field.uniform(2 * i)));  // many are equal
    safe.values()[i] = field.uniform(2 * i + 1) < 0.2 ? 0 : 1;
  }
  cost.at({3, 3}) = kFloatNan;
  const SiteParameters parameters{.count = 12, .separation_m = 5};
  const std::vector<BinIndex> sites = choose_sites(cost, safe, parameters);
  ASSERT_GT(sites.size(), 5U);
  const auto squared = [&](BinIndex bin) {
    return std::pow(spec.x(bin.col), 2) + std::pow(spec.y(bin.row), 2);
  };
  const auto key = [&](BinIndex bin) { return std::tuple(cost.at(bin), squared(bin), bin.row, bin.col); };
  const auto is_apart = [&](BinIndex bin, std::size_t rank) {
    for (std::size_t i = 0; i < rank; ++i)
      if (std::hypot(bin.row - sites[i].row, bin.col - sites[i].col) < 5) return false;
    return true;
  };
  for (std::size_t rank = 0; rank < sites.size(); ++rank) {
    EXPECT_TRUE(is_apart(sites[rank], rank));
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const BinIndex bin{row, col};
        if (safe.at(bin) != 1 || std::isnan(cost.at(bin)) || !is_apart(bin, rank)) continue;
        EXPECT_GE(key(bin), key(sites[rank]));
      }
  }
  EXPECT_TRUE(choose_sites(cost, Grid<std::int8_t>(spec), parameters).empty());
}

TEST(ChooseSites, NoBinIsChosenTwice) {
  const GridSpec spec = GridSpec::centered(1, 1);
  const std::vector<BinIndex> sites =
      choose_sites(Grid<float>(spec), Grid<std::int8_t>(spec, 1), {.count = 20, .separation_m = 0});
  ASSERT_EQ(sites.size(), 9U);
  EXPECT_EQ(sites[0], (BinIndex{1, 1}));
  EXPECT_EQ(sites[1], (BinIndex{0, 1}));
}

}  // namespace
}  // namespace landfall
