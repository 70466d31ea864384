// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "bins.h"
#include "chain/hazards/relief_prior.h"
#include "chain/hazards/scale_filter.h"
#include "chain/hazards/sharp_relief.h"
#include "map_noise.h"

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
    for (const BinIndex bin : Bins({row, row}, {row + 4, row + 4}))
      rocks.at(bin) = static_cast<float>(100 * kVariance);
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
  for (const auto [row, col] : Bins({90, 90}, {110, 110})) {
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

constexpr std::int64_t kBins = 200;
constexpr double kEdge = 0.05;

/// Ground of the function `height` of x and y, with noise of 1 sigma.
template <typename Height>
Grid<double> noisy(double sigma_m, const Height& height) {
  Grid<double> z = grid_of(GridSpec::centered(kBins / 2 * kEdge, kEdge), height);
  add_noise(z, sigma_m, 3);
  return z;
}

BinMask all_bins(const Grid<double>& z) { return BinMask(z.spec(), 1); }

double rolling(double x, double y) { return 0.2 * std::sin(x) * std::cos(1.3 * y) + 0.1 * x; }

/// Half an ellipsoid 0.8 m wide and 0.3 m high, on rolling terrain.
double rock(double x, double y) {
  const double r = std::hypot(x - 1, y + 1) / 0.4;
  return rolling(x, y) + (r < 1 ? 0.3 * std::sqrt(1 - r * r) : 0);
}

double step(double x, double y) { return rolling(x, y) + (x > 0.3 * y ? 0.15 : 0); }

TEST(SharpRelief, EvenReliefIsNot) {
  for (const double sigma_m : {0.001, 0.02}) {
    const Grid<double> z = noisy(sigma_m, rolling);
    EXPECT_FALSE(has_sharp_relief(z, all_bins(z))) << sigma_m;
  }
  const Grid<double> level = noisy(0, [](double, double) { return 0.0; });
  EXPECT_FALSE(has_sharp_relief(level, all_bins(level)));
}

TEST(SharpRelief, ARockAndAStepAre) {
  for (const double sigma_m : {0.001, 0.01}) {
    const Grid<double> rocky = noisy(sigma_m, rock);
    EXPECT_TRUE(has_sharp_relief(rocky, all_bins(rocky))) << sigma_m;
    const Grid<double> stepped = noisy(sigma_m, step);
    EXPECT_TRUE(has_sharp_relief(stepped, all_bins(stepped))) << sigma_m;
  }
}

TEST(SharpRelief, OnlyTheRegionCounts) {
  const Grid<double> z = noisy(0.001, rock);
  BinMask region = all_bins(z);
  for (const auto [row, col] : bins_of(z.spec()))
    if (std::hypot(z.spec().x(col) - 1, z.spec().y(row) + 1) < 0.6) region.at({row, col}) = 0;
  EXPECT_FALSE(has_sharp_relief(z, region));
  EXPECT_FALSE(has_sharp_relief(z, BinMask(z.spec())));
}

TEST(SharpRelief, BinsBesideAHoleDoNotCount) {
  Grid<double> z = noisy(0.001, rock);
  for (const auto [row, col] : bins_of(z.spec()))
    if (std::hypot(z.spec().x(col) - 1, z.spec().y(row) + 1) < 0.5)
      z.at({row, col}) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(has_sharp_relief(z, all_bins(z)));
}

constexpr std::array<double, 11> kLowPass = {3, 0, -25, 0, 150, 256, 150, 0, -25, 0, 3};
constexpr std::array<double, 5> kBlur = {1, 4, 6, 4, 1};

Grid<double> noise(const GridSpec& spec) {
  const RandomField field(5, RandomStream::range_noise);
  Grid<double> map(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) map.values()[i] = field.normal(i);
  return map;
}

/// A value of the map continued by point reflection, first along y, then along x.
double reflected(const Grid<double>& map, std::int64_t row, std::int64_t col) {
  const GridSpec& spec = map.spec();
  const auto mirrored = [](std::int64_t i, std::int64_t count) {
    return std::clamp<std::int64_t>(i < 0 ? -i : 2 * (count - 1) - i, 0, count - 1);
  };
  if (row < 0 || row >= spec.rows) {
    const std::int64_t edge = row < 0 ? 0 : spec.rows - 1;
    return 2 * reflected(map, edge, col) - reflected(map, mirrored(row, spec.rows), col);
  }
  if (col < 0 || col >= spec.cols) {
    const std::int64_t edge = col < 0 ? 0 : spec.cols - 1;
    return 2 * map.at({row, edge}) - map.at({row, mirrored(col, spec.cols)});
  }
  return map.at({row, col});
}

TEST(LowPass, EqualsItsDefinition) {
  const Grid<double> map = noise({0.1, -9, -7, 23, 19});
  for (const std::int64_t step : {1, 2, 8}) {  // at 8 the taps reach beyond the mirrored map
    const Grid<double> found = low_pass(map, step);
    for (const auto [row, col] : Bins({0, 0}, {23, 19})) {
      double sum = 0;
      for (const auto [r, c] : Bins({-5, -5}, {6, 6}))
        sum += kLowPass[static_cast<std::size_t>(r + 5)] * kLowPass[static_cast<std::size_t>(c + 5)] /
               (512.0 * 512) * reflected(map, row + r * step, col + c * step);
      ASSERT_NEAR(found.at({row, col}), sum, 1e-12) << step << ": " << row << ", " << col;
    }
  }
}

TEST(LowPass, KeepsAPlaneAndInsideAQuintic) {
  const GridSpec spec{0.1, -40, -40, 81, 81};
  Grid<double> plane(spec);
  Grid<double> quintic(spec);
  for (const auto [row, col] : Bins({0, 0}, {81, 81})) {
    plane.at({row, col}) = 3 + 0.2 * spec.x(col) - 0.1 * spec.y(row);
    quintic.at({row, col}) = std::pow(spec.x(col), 5) - std::pow(spec.y(row), 4) * spec.x(col);
  }
  const Grid<double> same = low_pass(plane, 4);
  const Grid<double> inside = low_pass(quintic, 2);
  for (const auto [row, col] : Bins({0, 0}, {81, 81})) {
    ASSERT_NEAR(same.at({row, col}), plane.at({row, col}), 1e-12);
    if (std::min({row, col, 80 - row, 80 - col}) < 10) continue;
    ASSERT_NEAR(inside.at({row, col}), quintic.at({row, col}), 1e-9);
  }
}

TEST(Blur, EqualsItsDefinition) {
  const Grid<double> map = noise({0.1, 4, -7, 13, 17});
  Grid<float> narrow(map.spec());
  std::ranges::transform(map.values(), narrow.values().begin(),
                         [](double v) { return static_cast<float>(v); });
  for (const std::int64_t step : {1, 4}) {
    const Grid<float> found = blur(narrow, step);
    for (const auto [row, col] : Bins({0, 0}, {13, 17})) {
      double sum = 0;
      for (const auto [r, c] : Bins({-2, -2}, {3, 3}))
        sum += kBlur[static_cast<std::size_t>(r + 2)] * kBlur[static_cast<std::size_t>(c + 2)] / 256 *
               map.at({std::clamp<std::int64_t>(row + r * step, 0, 12),
                       std::clamp<std::int64_t>(col + c * step, 0, 16)});
      ASSERT_NEAR(found.at({row, col}), sum, 1e-6) << step << ": " << row << ", " << col;
    }
  }
}

// The root of the sum of the squared response to a single bin.
TEST(NoiseGains, AreThoseOfAnImpulse) {
  const GridSpec spec{0.1, -80, -80, 161, 161};
  Grid<double> map(spec);
  map.at({80, 80}) = 1;
  const NoiseGains gains = noise_gains(3);
  const auto norm = [](const Grid<double>& values) {
    double sum = 0;
    for (const double value : values.values()) sum += value * value;
    return std::sqrt(sum);
  };
  for (std::int64_t j = 0; j < 3; ++j) {
    const Grid<double> smooth = low_pass(map, std::int64_t{1} << j);
    Grid<double> detail = map;
    for (std::size_t i = 0; i < spec.size(); ++i) detail.values()[i] -= smooth.values()[i];
    EXPECT_NEAR(gains.detail.at(static_cast<std::size_t>(j)), norm(detail), 1e-12);
    map = smooth;
  }
  EXPECT_NEAR(gains.rest, norm(map), 1e-12);
}

TEST(LowPass, DoesNotDependOnTheNumberOfThreads) {
  const Grid<double> map = noise({0.1, 0, 0, 70, 50});
  const Grid<double> found = low_pass(map, 2);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(std::ranges::equal(low_pass(map, 2).values(), found.values()));
  }
}

}  // namespace
}  // namespace landfall
