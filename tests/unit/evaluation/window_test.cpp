// SPDX-License-Identifier: GPL-3.0-or-later
// Window means and quantiles: by hand, and to the last bit against direct sums and a full sort.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "evaluation/window_mean.h"
#include "evaluation/window_quantile.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Grid<double> grid_of(const GridSpec& spec, std::initializer_list<double> values) {
  Grid<double> grid(spec);
  std::copy(values.begin(), values.end(), grid.values().begin());
  return grid;
}

Grid<double> noise(const GridSpec& spec, double nan_frac, std::uint64_t seed) {
  const RandomField values(seed, RandomStream::range_noise);
  const RandomField holes(seed, RandomStream::dropout);
  Grid<double> grid(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    grid.values()[i] = holes.uniform(i) < nan_frac ? kNan : values.normal(i);
  return grid;
}

bool same_bits(const Grid<double>& a, const Grid<double>& b) {
  return std::ranges::equal(a.values(), b.values(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

Grid<double> quantiles(const Grid<double>& error, std::int64_t half, double q) {
  const WindowMeans windows = window_means(error, half);
  const BinMask everywhere(error.spec(), 1);
  return window_quantile_naive(
      {.error = error, .windows = windows, .region = everywhere, .half_bins = half, .quantile = q});
}

struct Window {
  std::int64_t first_row, last_row, first_col, last_col;
};

Window clipped(const GridSpec& spec, BinIndex bin, std::int64_t half) {
  return {std::max<std::int64_t>(bin.row - half, 0), std::min(bin.row + half, spec.rows - 1),
          std::max<std::int64_t>(bin.col - half, 0), std::min(bin.col + half, spec.cols - 1)};
}

// The definition in window_mean.h, one window at a time.
double mean_oracle(const Grid<double>& values, BinIndex bin, std::int64_t half) {
  const Window w = clipped(values.spec(), bin, half);
  double sum = 0;
  int n = 0;
  for (std::int64_t row = w.first_row; row <= w.last_row; ++row) {
    double row_sum = 0;
    for (std::int64_t col = w.first_col; col <= w.last_col; ++col) {
      const double v = values.at({row, col});
      if (!std::isnan(v)) ++n;
      row_sum += std::isnan(v) ? 0.0 : v;
    }
    sum += row_sum;
  }
  return n == 0 ? kNan : sum / n;
}

double quantile_oracle(const Grid<double>& error, BinIndex bin, std::int64_t half, double q) {
  const Window w = clipped(error.spec(), bin, half);
  const double mean = mean_oracle(error, bin, half);
  std::vector<double> deviations;
  for (std::int64_t row = w.first_row; row <= w.last_row; ++row)
    for (std::int64_t col = w.first_col; col <= w.last_col; ++col)
      if (!std::isnan(error.at({row, col}))) deviations.push_back(std::abs(error.at({row, col}) - mean));
  if (deviations.empty()) return kNan;
  std::ranges::sort(deviations);
  const double h = static_cast<double>(deviations.size() - 1) * q;
  const auto k = static_cast<std::size_t>(h);
  const double frac = h - std::floor(h);
  return frac == 0 ? deviations[k] : deviations[k] + frac * (deviations[k + 1] - deviations[k]);
}

TEST(WindowMeans, ByHandWithClippingAndNan) {
  const WindowMeans windows = window_means(grid_of({1, 0, 0, 3, 3}, {1, 2, 3,     //
                                                                     4, kNan, 6,  //
                                                                     7, 8, 9}),
                                           1);
  EXPECT_EQ(windows.count.at({1, 1}), 8);
  EXPECT_EQ(windows.mean.at({1, 1}), 5);
  EXPECT_EQ(windows.count.at({0, 0}), 3);
  EXPECT_EQ(windows.mean.at({0, 0}), 7.0 / 3);
  EXPECT_EQ(windows.count.at({2, 1}), 5);
  EXPECT_EQ(windows.mean.at({2, 1}), 34.0 / 5);
}

TEST(WindowMeans, NoValidBinIsNan) {
  const WindowMeans windows = window_means(grid_of({1, 0, 0, 1, 4}, {kNan, kNan, kNan, 2}), 1);
  EXPECT_EQ(windows.count.at({0, 0}), 0);
  EXPECT_TRUE(std::isnan(windows.mean.at({0, 0})));
  EXPECT_EQ(windows.mean.at({0, 2}), 2);
}

// 2^53 + 1 rounds to 2^53: left to right the ones are lost, right to left they would make 2.
TEST(WindowMeans, SumsLeftToRightThenUpwards) {
  const WindowMeans row = window_means(grid_of({1, 0, 0, 1, 3}, {0x1p53, 1, 1}), 1);
  EXPECT_EQ(row.mean.at({0, 1}), 0x1p53 / 3);
  const WindowMeans column = window_means(grid_of({1, 0, 0, 3, 1}, {0x1p53, 1, 1}), 1);
  EXPECT_EQ(column.mean.at({1, 0}), 0x1p53 / 3);
  // The row of ones is summed first.
  const WindowMeans both = window_means(grid_of({1, 0, 0, 2, 2}, {0x1p53, 0, 1, 1}), 1);
  EXPECT_EQ(both.mean.at({0, 0}), (0x1p53 + 2) / 4);
}

TEST(WindowMeans, WindowLargerThanTheGrid) {
  const WindowMeans windows = window_means(grid_of({1, 0, 0, 2, 2}, {1, 2, 3, 4}), 100);
  for (const double mean : windows.mean.values()) EXPECT_EQ(mean, 2.5);
}

TEST(WindowQuantile, ByHand) {
  // One row of errors 0 0 0 0 10, mean 2: deviations 2 2 2 2 8. Median 2, largest 8, h = 3.8 at 0.95.
  const Grid<double> error = grid_of({1, 0, 0, 1, 5}, {0, 0, 0, 0, 10});
  EXPECT_EQ(quantiles(error, 2, 0.5).at({0, 2}), 2);
  EXPECT_EQ(quantiles(error, 2, 1).at({0, 2}), 8);
  EXPECT_NEAR(quantiles(error, 2, 0.95).at({0, 2}), 2 + 0.8 * 6, 1e-14);
  // Clipped to the last three: mean 10/3.
  EXPECT_EQ(quantiles(error, 2, 1).at({0, 4}), 10 - 10.0 / 3);
}

TEST(WindowQuantile, NanIsIgnoredAndOneBinHasNoDeviation) {
  const Grid<double> error = grid_of({1, 0, 0, 1, 4}, {kNan, 3, kNan, kNan});
  const Grid<double> rel = quantiles(error, 1, 0.95);
  EXPECT_EQ(rel.at({0, 0}), 0);
  EXPECT_EQ(rel.at({0, 2}), 0);
  EXPECT_TRUE(std::isnan(rel.at({0, 3})));
}

TEST(WindowQuantile, OnlyTheRegionIsComputed) {
  const Grid<double> error = noise({1, 0, 0, 5, 5}, 0, 1);
  const WindowMeans windows = window_means(error, 1);
  BinMask region(error.spec());
  region.at({2, 3}) = 1;
  const Grid<double> rel = window_quantile_naive(
      {.error = error, .windows = windows, .region = region, .half_bins = 1, .quantile = 0.5});
  EXPECT_EQ(std::ranges::count_if(rel.values(), [](double v) { return !std::isnan(v); }), 1);
  EXPECT_FALSE(std::isnan(rel.at({2, 3})));
}

TEST(WindowQuantile, ProgressRisesToOne) {
  const Grid<double> error = noise({1, 0, 0, 9, 5}, 0, 1);
  const WindowMeans windows = window_means(error, 1);
  const BinMask everywhere(error.spec(), 1);
  std::vector<double> fractions;
  static_cast<void>(window_quantile_naive(
      {.error = error, .windows = windows, .region = everywhere, .half_bins = 1, .quantile = 0.5},
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

TEST_P(WindowOracle, EqualToTheLastBit) {
  const auto& [spec, nan_frac, half, q] = GetParam();
  const Grid<double> error = noise(spec, nan_frac, 5);
  Grid<double> mean(spec);
  Grid<double> quantile(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      mean.at({row, col}) = mean_oracle(error, {row, col}, half);
      quantile.at({row, col}) = quantile_oracle(error, {row, col}, half, q);
    }
  }
  for (const std::size_t threads : {1U, 2U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(same_bits(window_means(error, half).mean, mean)) << threads << " threads";
    EXPECT_TRUE(same_bits(quantiles(error, half, q), quantile)) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Random, WindowOracle,
    testing::Values(RandomCase{{1, 0, 0, 70, 61}, 0.04, 17, 0.95}, RandomCase{{1, 0, 0, 45, 50}, 0, 3, 0.95},
                    RandomCase{{1, 0, 0, 270, 20}, 0.1, 150, 0.95},
                    RandomCase{{1, 0, 0, 40, 33}, 0.9, 2, 0.8}, RandomCase{{1, 0, 0, 30, 31}, 1, 4, 0.95},
                    RandomCase{{1, 0, 0, 1, 90}, 0.3, 6, 0.33}, RandomCase{{1, 0, 0, 90, 1}, 0.3, 6, 1},
                    RandomCase{{1, 0, 0, 20, 20}, 0.2, 0, 0.5}, RandomCase{{1, 0, 0, 12, 15}, 0.2, 40, 0}));

}  // namespace
}  // namespace landfall
