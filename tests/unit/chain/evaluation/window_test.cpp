// SPDX-License-Identifier: GPL-3.0-or-later
// Window means (Eq. 11) and quantiles (Eq. 12): by hand, and to the last bit against direct sums and a full
// sort.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <initializer_list>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "base/raster/window_mean.h"
#include "bins.h"
#include "chain/evaluation/quantile/window_quantile.h"
#include "constants.h"
#include "targets.h"

namespace landfall {
namespace {

Grid<double> noisy_grid(const GridSpec& spec, double nan_frac, std::uint64_t seed) {
  const RandomField values(seed, RandomStream::range_noise);
  const RandomField holes(seed, RandomStream::dropout);
  Grid<double> grid(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    grid.values()[i] = holes.uniform(i) < nan_frac ? kNan : values.normal(i);
  return grid;
}

bool equal_bits(const Grid<double>& a, const Grid<double>& b) {
  return std::ranges::equal(a.values(), b.values(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

Grid<double> quantiles(const Grid<double>& error, const Footprint& footprint, double q) {
  const WindowMeans windows = window_means(error, footprint);
  const BinMask everywhere(error.spec(), 1);
  return window_quantile_naive(
      {.error = error, .windows = windows, .footprint = footprint, .region = everywhere, .quantile = q});
}

/// The definition of a footprint, without the spans that it is kept as.
using InWindow = std::function<bool(std::int64_t row_offset, std::int64_t col_offset)>;

InWindow square_of(std::int64_t half) {
  return [=](std::int64_t i, std::int64_t j) { return std::max(std::abs(i), std::abs(j)) <= half; };
}
InWindow disc_of(std::int64_t squared_radius) {
  return [=](std::int64_t i, std::int64_t j) { return i * i + j * j <= squared_radius; };
}

/// NaN outside the grid.
double value_at(const Grid<double>& values, BinIndex bin) {
  return values.spec().contains(bin) ? values.at(bin) : kNan;
}

/// The valid values of one window, row by row, each row from left to right.
std::vector<double> window_values(const Grid<double>& values, BinIndex bin, const InWindow& in_window) {
  std::vector<double> found;
  for (const auto [row, col] : bins_of(values.spec()))
    if (in_window(row - bin.row, col - bin.col) && !std::isnan(values.at({row, col})))
      found.push_back(values.at({row, col}));
  return found;
}

double plus(double sum, double value) { return sum + (std::isnan(value) ? 0.0 : value); }

/// The trees of window_mean.h, one window at a time.
double mean_oracle(const Grid<double>& values, BinIndex bin, std::int64_t half, bool square,
                   const InWindow& in_window) {
  double sum = 0;
  for (std::int64_t i = -half; i <= half; ++i) {
    double row_sum = 0;
    if (square) {
      for (std::int64_t j = -half; j <= half; ++j)
        row_sum = plus(row_sum, value_at(values, {bin.row + i, bin.col + j}));
    } else {
      for (std::int64_t j = 0; in_window(i, j); ++j) {
        row_sum = plus(row_sum, value_at(values, {bin.row + i, bin.col - j}));
        if (j > 0) row_sum = plus(row_sum, value_at(values, {bin.row + i, bin.col + j}));
      }
    }
    sum += row_sum;
  }
  const std::size_t n = window_values(values, bin, in_window).size();
  return n == 0 ? kNan : sum / static_cast<double>(n);
}

double quantile_oracle(std::vector<double> deviations, double mean, double q) {
  if (deviations.empty()) return kNan;
  for (double& value : deviations) value = std::abs(value - mean);
  std::ranges::sort(deviations);
  const double h = static_cast<double>(deviations.size() - 1) * q;
  const auto k = static_cast<std::size_t>(h);
  const double frac = h - std::floor(h);
  return frac == 0 ? deviations[k] : deviations[k] + frac * (deviations[k + 1] - deviations[k]);
}

TEST(WindowMeans, ByHandWithClippingAndNan) {
  const WindowMeans windows = window_means(grid_with({1, 0, 0, 3, 3}, {1, 2, 3,     //
                                                                       4, kNan, 6,  //
                                                                       7, 8, 9}),
                                           Footprint::square(1));
  EXPECT_EQ(windows.count.at({1, 1}), 8);
  EXPECT_EQ(windows.mean.at({1, 1}), 5);
  EXPECT_EQ(windows.count.at({0, 0}), 3);
  EXPECT_EQ(windows.mean.at({0, 0}), 7.0 / 3);
  EXPECT_EQ(windows.count.at({2, 1}), 5);
  EXPECT_EQ(windows.mean.at({2, 1}), 34.0 / 5);
}

TEST(WindowMeans, NoValidBinIsNan) {
  const WindowMeans windows =
      window_means(grid_with({1, 0, 0, 1, 4}, {kNan, kNan, kNan, 2}), Footprint::square(1));
  EXPECT_EQ(windows.count.at({0, 0}), 0);
  EXPECT_TRUE(std::isnan(windows.mean.at({0, 0})));
  EXPECT_EQ(windows.mean.at({0, 2}), 2);
}

// 2^53 + 1 rounds to 2^53: left to right the ones are lost, right to left they would make 2.
TEST(WindowMeans, SumsLeftToRightThenUpwards) {
  const WindowMeans row = window_means(grid_with({1, 0, 0, 1, 3}, {0x1p53, 1, 1}), Footprint::square(1));
  EXPECT_EQ(row.mean.at({0, 1}), 0x1p53 / 3);
  const WindowMeans column = window_means(grid_with({1, 0, 0, 3, 1}, {0x1p53, 1, 1}), Footprint::square(1));
  EXPECT_EQ(column.mean.at({1, 0}), 0x1p53 / 3);
  // The row of ones is summed first.
  const WindowMeans both = window_means(grid_with({1, 0, 0, 2, 2}, {0x1p53, 0, 1, 1}), Footprint::square(1));
  EXPECT_EQ(both.mean.at({0, 0}), (0x1p53 + 2) / 4);
}

TEST(WindowMeans, WindowLargerThanTheGrid) {
  const WindowMeans windows = window_means(grid_with({1, 0, 0, 2, 2}, {1, 2, 3, 4}), Footprint::square(100));
  for (const double mean : windows.mean.values()) EXPECT_EQ(mean, 2.5);
}

TEST(Windows, EveryInstructionSetGivesTheSameBits) {
  const Grid<double> error = noisy_grid({1, 0, 0, 90, 153}, 0.1, 5);
  const BinMask everywhere(error.spec(), 1);
  for (const Footprint& footprint : {Footprint::square(6), Footprint::disc(40)}) {
    const WindowMeans expected = window_means(error, footprint);
    const WindowQuantileInput input{
        .error = error, .windows = expected, .footprint = footprint, .region = everywhere};
    const Grid<double> expected_quantiles = window_quantile_naive(input);
    on_every_target([&] {
      const WindowMeans found = window_means(error, footprint);
      EXPECT_TRUE(equal_bits(found.mean, expected.mean));
      EXPECT_TRUE(std::ranges::equal(found.count.values(), expected.count.values()));
      EXPECT_TRUE(equal_bits(window_quantile(input), expected_quantiles));
    });
  }
}

TEST(WindowQuantile, ByHand) {
  // One row of errors 0 0 0 0 10, mean 2: deviations 2 2 2 2 8. Median 2, largest 8, h = 3.8 at 0.95.
  const Grid<double> error = grid_with({1, 0, 0, 1, 5}, {0, 0, 0, 0, 10});
  EXPECT_EQ(quantiles(error, Footprint::square(2), 0.5).at({0, 2}), 2);
  EXPECT_EQ(quantiles(error, Footprint::square(2), 1).at({0, 2}), 8);
  EXPECT_NEAR(quantiles(error, Footprint::square(2), 0.95).at({0, 2}), 2 + 0.8 * 6, 1e-14);
  // Clipped to the last three: mean 10/3.
  EXPECT_EQ(quantiles(error, Footprint::square(2), 1).at({0, 4}), 10 - 10.0 / 3);
}

TEST(WindowQuantile, NanIsIgnoredAndOneBinHasNoDeviation) {
  const Grid<double> error = grid_with({1, 0, 0, 1, 4}, {kNan, 3, kNan, kNan});
  const Grid<double> rel = quantiles(error, Footprint::square(1), 0.95);
  EXPECT_EQ(rel.at({0, 0}), 0);
  EXPECT_EQ(rel.at({0, 2}), 0);
  EXPECT_TRUE(std::isnan(rel.at({0, 3})));
}

TEST(WindowQuantile, OnlyTheRegionIsComputed) {
  const Grid<double> error = noisy_grid({1, 0, 0, 5, 5}, 0, 1);
  const Footprint footprint = Footprint::square(1);
  const WindowMeans windows = window_means(error, footprint);
  BinMask region(error.spec());
  region.at({2, 3}) = 1;
  const Grid<double> rel = window_quantile_naive(
      {.error = error, .windows = windows, .footprint = footprint, .region = region, .quantile = 0.5});
  EXPECT_EQ(std::ranges::count_if(rel.values(), [](double v) { return !std::isnan(v); }), 1);
  EXPECT_FALSE(std::isnan(rel.at({2, 3})));
}

TEST(WindowQuantile, ProgressRisesToOne) {
  const Grid<double> error = noisy_grid({1, 0, 0, 9, 5}, 0, 1);
  const Footprint footprint = Footprint::square(1);
  const WindowMeans windows = window_means(error, footprint);
  const BinMask everywhere(error.spec(), 1);
  std::vector<double> fractions;
  static_cast<void>(window_quantile_naive(
      {.error = error, .windows = windows, .footprint = footprint, .region = everywhere, .quantile = 0.5},
      [&](double f) { fractions.push_back(f); }));
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1);
}

struct RandomCase {
  GridSpec spec;
  double nan_frac;
  std::int64_t half_bins;
  double quantile;
};

class WindowOracle : public testing::TestWithParam<RandomCase> {};

void expect_same_as_oracle(const RandomCase& c, const Footprint& footprint, const InWindow& in_window) {
  const Grid<double> error = noisy_grid(c.spec, c.nan_frac, 5);
  Grid<double> mean(c.spec);
  Grid<double> quantile(c.spec);
  for (const BinIndex bin : bins_of(c.spec)) {
    mean.at(bin) = mean_oracle(error, bin, footprint.half_bins(), footprint.is_square(), in_window);
    quantile.at(bin) = quantile_oracle(window_values(error, bin, in_window), mean.at(bin), c.quantile);
  }
  for (const std::size_t threads : {1U, 2U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(equal_bits(window_means(error, footprint).mean, mean)) << threads << " threads";
    EXPECT_TRUE(equal_bits(quantiles(error, footprint, c.quantile), quantile)) << threads << " threads";
  }
}

TEST_P(WindowOracle, SquaresEqualToTheLastBit) {
  const std::int64_t half = GetParam().half_bins;
  expect_same_as_oracle(GetParam(), Footprint::square(half), square_of(half));
}

TEST_P(WindowOracle, DiscsEqualToTheLastBit) {
  const std::int64_t squared_radius = GetParam().half_bins * (GetParam().half_bins + 1);
  expect_same_as_oracle(GetParam(), Footprint::disc(squared_radius), disc_of(squared_radius));
}

INSTANTIATE_TEST_SUITE_P(
    Random, WindowOracle,
    testing::Values(RandomCase{{1, 0, 0, 70, 61}, 0.04, 17, 0.95}, RandomCase{{1, 0, 0, 45, 50}, 0, 3, 0.95},
                    RandomCase{{1, 0, 0, 150, 20}, 0.1, 70, 0.95}, RandomCase{{1, 0, 0, 40, 33}, 0.9, 2, 0.8},
                    RandomCase{{1, 0, 0, 30, 31}, 1, 4, 0.95}, RandomCase{{1, 0, 0, 1, 90}, 0.3, 6, 0.33},
                    RandomCase{{1, 0, 0, 90, 1}, 0.3, 6, 1}, RandomCase{{1, 0, 0, 20, 20}, 0.2, 0, 0.5},
                    RandomCase{{1, 0, 0, 12, 15}, 0.2, 40, 0},
                    // Two bands of rows; a row that fills its vectors.
                    RandomCase{{1, 0, 0, 140, 3}, 0.1, 4, 0.95}, RandomCase{{1, 0, 0, 5, 32}, 0.1, 3, 0.95}));

}  // namespace
}  // namespace landfall
