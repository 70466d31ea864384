// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/relief_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "base/numerics/random.h"

namespace landfall {
namespace {

constexpr double kVariance = 1e-4;

/// Independent normal details: noise of variance 1e-4 everywhere, and relief where `relief` is not 0.
Grid<float> details(const Grid<float>& relief, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::range_noise);
  Grid<float> map(relief.spec());
  for (std::size_t i = 0; i < map.spec().size(); ++i)
    map.values()[i] =
        static_cast<float>(std::sqrt(kVariance + static_cast<double>(relief.values()[i])) * field.normal(i));
  return map;
}

ScaleRelief found(const Grid<float>& detail, const Grid<float>* coarser = nullptr) {
  const Grid<float> noise(detail.spec(), static_cast<float>(kVariance));
  return relief_of({detail, noise, Grid<float>(detail.spec(), 1), 1}, coarser);
}

double mean(const Grid<float>& map) {
  double sum = 0;
  for (const float value : map.values()) sum += value;
  return sum / static_cast<double>(map.spec().size());
}

TEST(ReliefOf, NoiseAloneHasNone) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  const ScaleRelief relief = found(details(Grid<float>(spec), 1));
  EXPECT_LT(mean(relief.gain), 0.1);
  EXPECT_LT(mean(relief.spread_m2), 0.12 * kVariance);
}

TEST(ReliefOf, EqualReliefIsFound) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  for (const double ratio : {1.0, 10.0, 300.0}) {
    const ScaleRelief relief = found(details(Grid<float>(spec, static_cast<float>(ratio * kVariance)), 2));
    EXPECT_NEAR(mean(relief.gain), ratio / (1 + ratio), 0.08) << ratio;
    EXPECT_NEAR(mean(relief.relief_m2) / (ratio * kVariance), 1, 0.35) << ratio;
  }
}

// A few rocks on level terrain: what is seen of each is kept, between them all is noise.
TEST(ReliefOf, AFewRocks) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  Grid<float> rocks(spec);
  for (std::int64_t row = 20; row < spec.rows; row += 40)
    for (std::int64_t r = row; r < row + 4; ++r)
      for (std::int64_t c = row; c < row + 4; ++c) rocks.at({r, c}) = static_cast<float>(100 * kVariance);
  const ScaleRelief relief = found(details(rocks, 3));
  EXPECT_GT(relief.gain.at({22, 22}), 0.9F);
  EXPECT_LT(relief.gain.at({22, 60}), 0.16F);
}

// Relief that the next coarser scale does not have is taken for noise.
TEST(ReliefOf, IsNotRougherThanTheCoarserScale) {
  const GridSpec spec = GridSpec::centered(3, 0.05);
  const Grid<float> detail = details(Grid<float>(spec, static_cast<float>(0.3 * kVariance)), 4);
  const Grid<float> smooth(spec, static_cast<float>(0.002 * kVariance));
  const Grid<float> rough(spec, static_cast<float>(3 * kVariance));
  EXPECT_LT(mean(found(detail, &smooth).gain), 0.02);
  EXPECT_NEAR(mean(found(detail, &rough).gain), mean(found(detail).gain), 0.01);
}

// Bins that were not measured have the relief of those around, and gain nothing from their own detail.
TEST(ReliefOf, WhatWasNotSeenHasTheReliefAround) {
  const GridSpec spec = GridSpec::centered(5, 0.05);
  Grid<float> detail = details(Grid<float>(spec, static_cast<float>(4 * kVariance)), 5);
  Grid<float> seen(spec, 1);
  for (std::int64_t row = 90; row < 110; ++row)
    for (std::int64_t col = 90; col < 110; ++col) {
      detail.at({row, col}) = 0;
      seen.at({row, col}) = 0;
    }
  const ScaleRelief relief =
      relief_of({detail, Grid<float>(spec, static_cast<float>(kVariance)), seen, 1}, nullptr);
  EXPECT_EQ(relief.gain.at({100, 100}), 0);
  EXPECT_NEAR(relief.spread_m2.at({100, 100}) / kVariance, 4, 1);
  EXPECT_LT(relief.spread_m2.at({50, 50}) / kVariance, 1.1);
}

TEST(PriorCells, AreAtLeastTwoBins) {
  EXPECT_EQ(prior_cell_bins(0.05), 12);
  EXPECT_EQ(prior_cell_bins(0.1), 6);
  EXPECT_EQ(prior_cell_bins(1), 2);
}

}  // namespace
}  // namespace landfall
