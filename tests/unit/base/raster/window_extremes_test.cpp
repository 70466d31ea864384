// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/window_extremes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "constants.h"

namespace landfall {
namespace {

struct Extremes {
  double minimum = kNan, largest = kNan;
};

/// Bin by bin.
Extremes of_window(const Grid<double>& values, BinIndex centre, std::int64_t half_bins) {
  Extremes found;
  const GridSpec& spec = values.spec();
  for (std::int64_t row = std::max<std::int64_t>(0, centre.row - half_bins);
       row <= std::min(spec.rows - 1, centre.row + half_bins); ++row)
    for (std::int64_t col = std::max<std::int64_t>(0, centre.col - half_bins);
         col <= std::min(spec.cols - 1, centre.col + half_bins); ++col) {
      found.minimum = std::fmin(found.minimum, values.at({row, col}));
      found.largest = std::fmax(found.largest, values.at({row, col}));
    }
  return found;
}

Grid<double> random_map(const GridSpec& spec, std::uint64_t seed, double hole_frac) {
  const RandomField field(seed, RandomStream::dropout);
  Grid<double> values(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    values.values()[i] = field.uniform(i, 1) < hole_frac ? kNan : field.normal(i);
  return values;
}

void expect_window_extremes(const Grid<double>& values, std::int64_t half_bins) {
  const Grid<double> minimum = window_min(values, half_bins);
  const Grid<double> largest = window_max(values, half_bins);
  for (std::int64_t row = 0; row < values.spec().rows; ++row)
    for (std::int64_t col = 0; col < values.spec().cols; ++col) {
      const Extremes expected = of_window(values, {row, col}, half_bins);
      const auto is_equal = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
      ASSERT_TRUE(is_equal(minimum.at({row, col}), expected.minimum))
          << row << " " << col << " " << half_bins;
      ASSERT_TRUE(is_equal(largest.at({row, col}), expected.largest))
          << row << " " << col << " " << half_bins;
    }
}

TEST(WindowExtremes, OfARow) {
  Grid<double> values({.resolution_m = 1, .first_row = 0, .first_col = 0, .rows = 1, .cols = 6});
  std::ranges::copy(std::array{3.0, 1.0, -2.0, kNan, 5.0, 4.0}, values.values().begin());
  const Grid<double> largest = window_max(values, 1);
  const Grid<double> minimum = window_min(values, 1);
  EXPECT_TRUE(std::ranges::equal(largest.values(), std::array{3.0, 3.0, 1.0, 5.0, 5.0, 5.0}));
  EXPECT_TRUE(std::ranges::equal(minimum.values(), std::array{1.0, -2.0, -2.0, -2.0, 4.0, 4.0}));
}

TEST(WindowExtremes, EqualAllBinsOfTheWindow) {
  std::uint64_t seed = 0;
  for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 40}, {40, 1}, {23, 31}, {40, 70}})
    for (const std::int64_t half_bins : {0, 1, 2, 5, 11, 200})
      for (const double hole_frac : {0.0, 0.1, 0.95})
        expect_window_extremes(
            random_map({.resolution_m = 0.1, .first_row = 0, .first_col = 0, .rows = rows, .cols = cols},
                       ++seed, hole_frac),
            half_bins);
}

TEST(WindowExtremes, TheSameAtAnyNumberOfThreads) {
  const Grid<double> values = random_map(GridSpec::centered(10, 0.1), 1, 0.2);
  const auto bits = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    const Grid<double> largest = window_max(values, 7);
    std::vector<std::uint64_t> all;
    for (const double value : largest.values()) all.push_back(std::bit_cast<std::uint64_t>(value));
    return all;
  };
  EXPECT_EQ(bits(1), bits(2));
  EXPECT_EQ(bits(1), bits(7));
}

}  // namespace
}  // namespace landfall
