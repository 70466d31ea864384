// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/large_fractal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "band_law.h"
#include "base/core/parallel.h"
#include "structure_function.h"

namespace landfall {
namespace {

constexpr GridSpec kGrid{0.5, -500, -450, 1001, 901};

Grid<double> whole(const FractalBase& law, const FractalDraw& draw, const GridSpec& spec = kGrid) {
  Grid<double> z(spec);
  LargeFractal(law, draw, spec).add_to(z);
  return z;
}

Grid<double> in_strips(const FractalBase& law, std::int64_t height) {
  Grid<double> z(kGrid);
  LargeFractal fractal(law, {3, 1}, kGrid);
  for (std::int64_t row = 0; row < kGrid.rows; row += height) {
    GridSpec spec = kGrid;
    spec.first_row += row;
    spec.rows = std::min(height, kGrid.rows - row);
    Grid<double> strip(spec);
    fractal.add_to(strip);
    std::ranges::copy(strip.values(), z.row(row).begin());
  }
  return z;
}

bool same_values(const Grid<double>& a, const Grid<double>& b) {
  return std::ranges::equal(a.values(), b.values());
}

TEST(LargeFractal, StripsChangeNothing) {
  const FractalBase law{0.7, 0.3, 5};
  const Grid<double> all = whole(law, {3, 1});
  for (const std::int64_t height : {64, 100, 384, 768}) EXPECT_TRUE(same_values(all, in_strips(law, height)));
}

TEST(LargeFractal, AnyThreadCountGivesTheSame) {
  const FractalBase law{0.7, 0.3, 5};
  const Grid<double> all = whole(law, {7, 0});
  const ThreadLimit one(1);
  EXPECT_TRUE(same_values(all, whole(law, {7, 0})));
  EXPECT_FALSE(same_values(all, whole(law, {8, 0})));
  EXPECT_FALSE(same_values(all, whole(law, {7, 1})));
}

class LargeStructureFunction : public ::testing::TestWithParam<double> {};

// Waves up to 200 nodes: both bands, cut at 64 nodes. Lags from one node to beyond the cut.
TEST_P(LargeStructureFunction, FollowsTheLawInABand) {
  const FractalBase law{GetParam(), 0.3, 5, 100};
  const std::vector<std::int64_t> lags = {1, 2, 6, 24, 48, 96};
  std::vector<double> squares(lags.size());
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Grid<double> z = whole(law, {seed, 0});
    for (std::size_t i = 0; i < lags.size(); ++i) squares[i] += squared_deviation(z, lags[i]) / 3;
  }
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double expected_m = band_deviation_m(law, 100, static_cast<double>(lags[i]) * kGrid.resolution_m);
    EXPECT_NEAR(std::sqrt(squares[i]) / expected_m, 1, 0.05) << "lag " << lags[i];
  }
}

// Without a limit, 2 % in nu: the mixed patches of the seams and the interpolated long waves. The mean of 8
// realisations may be six of its standard errors off: by chance, in fewer than 1 of 100 runs.
TEST_P(LargeStructureFunction, FollowsTheLawAtAllScales) {
  const FractalBase law{GetParam(), 0.3, 5};
  const std::vector<std::int64_t> lags = {1, 2, 6, 20, 60, 200, 800};
  const auto ratios = squared_ratios(law, lags, 8, [&](std::uint64_t seed) { return whole(law, {seed, 0}); });
  for (std::size_t i = 0; i < lags.size(); ++i)
    EXPECT_NEAR(ratios[i].mean, 1, 0.04 + 6 * ratios[i].error) << "lag " << lags[i];
}

INSTANTIATE_TEST_SUITE_P(Hurst, LargeStructureFunction, ::testing::Values(0.5, 0.8));

/// Mean squared differences of nodes `lag` apart along x, by the column of the first node modulo the patches'
/// step.
std::vector<double> squares_by_column(const FractalBase& law, std::int64_t lag, int seeds) {
  std::vector<double> sums(384);
  std::vector<double> counts(384);
  for (int seed = 1; seed <= seeds; ++seed) {
    const Grid<double> z = whole(law, {static_cast<std::uint64_t>(seed), 0});
    for (std::int64_t r = 0; r < kGrid.rows; ++r)
      for (std::int64_t c = 0; c + lag < kGrid.cols; ++c) {
        sums[static_cast<std::size_t>(c % 384)] += squared_step(z.at({r, c + lag}), z.at({r, c}));
        counts[static_cast<std::size_t>(c % 384)] += 1;
      }
  }
  for (std::size_t i = 0; i < 384; ++i) sums[i] /= counts[i];
  return sums;
}

// Shorter waves alone, by the place on a patch: columns 0 to 255 are one patch's own, the others are mixed.
TEST(LargeFractal, NoSeamShows) {
  const FractalBase law{0.7, 0.3, 5, 32};
  for (const std::int64_t lag : {1, 8, 24}) {
    const std::vector<double> squares = squares_by_column(law, lag, 5);
    const auto mean = [&](std::size_t first, std::size_t last) {
      double sum = 0;
      for (std::size_t i = first; i < last; ++i) sum += squares[i];
      return sum / static_cast<double>(last - first);
    };
    const double own = mean(0, 256 - 24);
    for (const std::size_t first : {256U, 288U, 320U, 352U})
      EXPECT_NEAR(std::sqrt(mean(first, first + 32 - 24 * (first == 352U ? 1 : 0)) / own), 1, 0.05)
          << lag << ' ' << first;
  }
}

TEST(LargeFractal, NoReliefIsFlat) {
  const Grid<double> z = whole({0.7, 0, 5}, {1, 0});
  EXPECT_TRUE(std::ranges::all_of(z.values(), [](double value) { return value == 0; }));
}

}  // namespace
}  // namespace landfall
