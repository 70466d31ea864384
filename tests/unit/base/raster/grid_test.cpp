// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "base/raster/footprint.h"
#include "base/raster/grid_spec.h"
#include "base/raster/layer_check.h"
#include "base/raster/value_range.h"
#include "base/raster/window_extremes.h"
#include "bins.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

TEST(Footprint, Square) {
  const Footprint footprint = Footprint::square(2);
  EXPECT_TRUE(footprint.is_square());
  EXPECT_EQ(footprint.half_bins(), 2);
  for (const std::int64_t offset : {-2, -1, 0, 1, 2}) EXPECT_EQ(footprint.half_width(offset), 2);
}

// 5^2 = 3^2 + 4^2: the radius of 5 bins holds what lies on the circle.
TEST(Footprint, DiscHoldsItsCircle) {
  const Footprint footprint = Footprint::disc(25);
  EXPECT_FALSE(footprint.is_square());
  EXPECT_EQ(footprint.half_bins(), 5);
  const std::int64_t widths[] = {5, 4, 4, 4, 3, 0};
  for (std::int64_t offset = 0; offset <= 5; ++offset) {
    EXPECT_EQ(footprint.half_width(offset), widths[offset]);
    EXPECT_EQ(footprint.half_width(-offset), widths[offset]);
  }
}

TEST(Footprint, DiscsCountLatticePoints) {
  for (std::int64_t squared = 0; squared < 200; ++squared) {
    const Footprint footprint = Footprint::disc(squared);
    std::int64_t points = 0;
    std::int64_t squares = 0;
    for (const auto [i, j] : Bins({-15, -15}, {16, 16}))
      if (i * i + j * j <= squared) {
        ++points;
        squares += j * j;
      }
    EXPECT_EQ(footprint.bin_count(), points) << squared;
    EXPECT_EQ(footprint.squared_offsets(), squares) << squared;
  }
}

TEST(GridSpec, PapersDemIs2001Square) {
  const GridSpec dem = GridSpec::centered(50, 0.05);
  EXPECT_EQ(dem.rows, 2001);
  EXPECT_EQ(dem.cols, 2001);
  EXPECT_EQ(dem.x(0), -50);
  EXPECT_EQ(dem.x(1000), 0);
  EXPECT_EQ(dem.y(2000), 50);
}

TEST(GridSpec, RefusesAHalfWidthThatIsNoMultiple) {
  EXPECT_THROW(GridSpec::centered(50.01, 0.05), UsageError);
  EXPECT_THROW(GridSpec::centered(0.01, 0.05), UsageError);
  EXPECT_THROW(GridSpec::centered(-50, 0.05), UsageError);
  EXPECT_THROW(GridSpec::centered(50, 0), UsageError);
  EXPECT_THROW(GridSpec::centered(50, std::numeric_limits<double>::quiet_NaN()), UsageError);
  EXPECT_NO_THROW(GridSpec::centered(0.3, 0.1));  // 0.3 / 0.1 = 2.9999999999999996
}

// Bins are half-open, [-s/2, s/2) about the centre, on both sides of zero: never a truncation toward zero.
TEST(GridSpec, BinEdgesAndNegativeCoordinates) {
  const GridSpec grid = GridSpec::centered(2, 0.5);  // centres -2, -1.5, .., 2: nine bins
  const auto col = [&](double x) { return grid.bin_of(x, 0).col; };
  EXPECT_EQ(col(0.0), 4);
  EXPECT_EQ(col(0.2499), 4);
  EXPECT_EQ(col(0.25), 5);
  EXPECT_EQ(col(-0.25), 4);
  EXPECT_EQ(col(-0.2501), 3);
  EXPECT_EQ(col(-0.75), 3);
  EXPECT_EQ(col(-0.7501), 2);
  EXPECT_EQ(col(-2.25), 0);
  EXPECT_FALSE(grid.contains(grid.bin_of(-2.2501, 0)));
  EXPECT_FALSE(grid.contains(grid.bin_of(2.25, 0)));
  EXPECT_EQ(grid.bin_of(0, -0.75).row, 3);
}

TEST(GridSpec, WildCoordinatesLieOutside) {
  const GridSpec grid = GridSpec::centered(2, 0.5);
  for (const double wild :
       {1e300, -1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_FALSE(grid.contains(grid.bin_of(wild, 0)));
    EXPECT_FALSE(grid.contains(grid.bin_of(0, wild)));
  }
}

template <class T>
std::string layer_refusal(const Grid<T>& layer, LayerValues allowed) {
  return refusal<FormatError>([&] { require_values(layer, "layer", allowed); });
}

TEST(LayerCheck, NamesTheFirstInfiniteValue) {
  Grid<float> layer(GridSpec::centered(1, 0.5));
  EXPECT_EQ(layer_refusal(layer, LayerValues::finite), "accepted");
  layer.at({3, 4}) = -HUGE_VALF;
  EXPECT_EQ(layer_refusal(layer, LayerValues::finite), "layer: the value in row 3, column 4 is infinite");
  layer.at({1, 2}) = HUGE_VALF;
  for (const LayerValues allowed : {LayerValues::finite, LayerValues::not_negative})
    EXPECT_EQ(layer_refusal(layer, allowed), "layer: the value in row 1, column 2 is infinite");
}

TEST(LayerCheck, RefusesNegativeValuesOnlyWhereTheyMeanNothing) {
  Grid<double> layer(GridSpec::centered(1, 0.5));
  layer.at({0, 0}) = std::nan("");
  layer.at({0, 1}) = -0.0;
  layer.at({2, 0}) = -0.05;
  EXPECT_EQ(layer_refusal(layer, LayerValues::finite), "accepted");
  EXPECT_EQ(layer_refusal(layer, LayerValues::not_negative),
            "layer: the value in row 2, column 0 is -0.05, and must be 0 or more");
  layer.at({2, 0}) = 0;
  EXPECT_EQ(layer_refusal(layer, LayerValues::not_negative), "accepted");
}

TEST(LayerCheck, TakesCounts) {
  Grid<std::int32_t> counts(GridSpec::centered(1, 0.5), 2147483647);
  EXPECT_EQ(layer_refusal(counts, LayerValues::not_negative), "accepted");
  counts.at({4, 4}) = -1;
  EXPECT_EQ(layer_refusal(counts, LayerValues::not_negative),
            "layer: the value in row 4, column 4 is -1, and must be 0 or more");
}

template <class T>
std::optional<std::array<double, 2>> range_of(const std::vector<T>& values) {
  ValueRange range;
  range.add(std::span<const T>(values));
  return range.pair();
}

// 8 values are compared at once: the extremes lie in and behind such a group.
TEST(ValueRange, FindsTheExtremesAtEveryPosition) {
  for (std::size_t size = 1; size <= 20; ++size)
    for (std::size_t i = 0; i < size; ++i) {
      std::vector<double> values(size, 2);
      values[i] = -5;
      EXPECT_EQ(range_of(values), (std::array{-5.0, size == 1 ? -5.0 : 2.0}));
      values[i] = 7;
      EXPECT_EQ(range_of(values), (std::array{size == 1 ? 7.0 : 2.0, 7.0}));
    }
}

TEST(ValueRange, IgnoresNanAndIsEmptyWithoutOtherValues) {
  EXPECT_EQ(range_of<double>({kNan, 3, kNan, -1, kNan, kNan, kNan, kNan, kNan, 2}), (std::array{-1.0, 3.0}));
  EXPECT_EQ(range_of<float>(std::vector<float>(11, std::nanf(""))), std::nullopt);
  EXPECT_EQ(range_of<double>({}), std::nullopt);
}

TEST(ValueRange, HoldsTheValuesOfEveryType) {
  EXPECT_EQ(range_of<std::int8_t>({-128, 0, 127}), (std::array{-128.0, 127.0}));
  EXPECT_EQ(range_of<std::int32_t>({0, 0, 2147483647}), (std::array{0.0, 2147483647.0}));
  EXPECT_EQ(range_of<float>({0.1F, -0.3F}), (std::array{double{-0.3F}, double{0.1F}}));
}

TEST(ValueRange, JoinsRangesAndHasNoNegativeZero) {
  const std::vector<double> zeros = {0.0, -0.0};
  ValueRange a;
  ValueRange b;
  a.add(std::span<const double>(zeros).first(1));
  b.add(std::span<const double>(zeros).last(1));
  b.add(a);
  b.add(ValueRange());
  ASSERT_TRUE(b.pair().has_value());
  EXPECT_FALSE(std::signbit((*b.pair())[0]) || std::signbit((*b.pair())[1]));
}

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
  for (const auto [row, col] : bins_of(values.spec())) {
    const Extremes expected = of_window(values, {row, col}, half_bins);
    const auto is_equal = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    ASSERT_TRUE(is_equal(minimum.at({row, col}), expected.minimum)) << row << " " << col << " " << half_bins;
    ASSERT_TRUE(is_equal(largest.at({row, col}), expected.largest)) << row << " " << col << " " << half_bins;
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
