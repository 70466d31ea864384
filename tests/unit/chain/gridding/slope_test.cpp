// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/slope.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bins.h"
#include "map_layers.h"
#include "return_columns.h"

namespace landfall {
namespace {

constexpr double kSlopeX = 0.5;
constexpr double kSlopeY = -3.25;

double plane(double x, double y) { return 7 + kSlopeX * x + kSlopeY * y; }

ReturnPoint on_plane(double x, double y) { return {.x_est = x, .y_est = y, .z_est = plane(x, y)}; }

// One return somewhere in each bin for which `keep` holds.
template <class Keep>
WeightedMeanAccumulator scattered(const GridSpec& spec, Keep keep) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> offset(-0.49, 0.49);
  std::vector<ReturnPoint> points;
  for (const auto [row, col] : bins_of(spec))
    if (keep(row, col))
      points.push_back(on_plane(spec.x(col) + offset(random) * spec.resolution_m,
                                spec.y(row) + offset(random) * spec.resolution_m));
  return accumulated(spec, points);
}

void expect_slope(const Slope& slope) {
  EXPECT_NEAR(slope.x, kSlopeX, 1e-5);
  EXPECT_NEAR(slope.y, kSlopeY, 1e-5);
}

TEST(Slope, APlaneIsExactAlsoAtTheEdgesAndCorners) {
  const GridSpec spec = GridSpec::centered(0.25, 0.05);
  const Grid<Slope> slopes = slope_layer(scattered(spec, [](auto, auto) { return true; }));
  for (const Slope& slope : slopes.values()) expect_slope(slope);
}

TEST(Slope, WeightsAreTheSumsOfWeights) {
  // Bins of 1 m, returns in the centres, z = 1 in the eastern column's middle bin only, 0 elsewhere: by hand
  // with unit weights g_x = sum x z / sum x^2 = 1 / 6; with two returns in that bin its weight is 2.
  const GridSpec spec = GridSpec::centered(1, 1);
  std::vector<ReturnPoint> points;
  for (double y = -1; y <= 1; ++y)
    for (double x = -1; x <= 1; ++x)
      points.push_back({.x_est = x, .y_est = y, .z_est = x == 1 && y == 0 ? 1.0 : 0.0});
  EXPECT_FLOAT_EQ(slope_layer(accumulated(spec, points)).at({1, 1}).x, 1.0F / 6);
  points.push_back({.x_est = 1, .y_est = 0, .z_est = 1});
  // Weighted: mean x 0.1, mean z 0.2; sum w x z - 10 mx mz = 1.8, sum w x x - 10 mx^2 = 6.9.
  EXPECT_FLOAT_EQ(slope_layer(accumulated(spec, points)).at({1, 1}).x, static_cast<float>(1.8 / 6.9));
  EXPECT_NEAR(slope_layer(accumulated(spec, points)).at({1, 1}).y, 0, 1e-15);
}

// Every second bin of every second row: 3 x 3 bins hold 1 to 4 returns, 5 x 5 hold 4 to 9.
TEST(Slope, SparseReturnsTakeALargerNeighbourhood) {
  const GridSpec spec = GridSpec::centered(0.5, 0.05);
  const Grid<Slope> slopes =
      slope_layer(scattered(spec, [](auto row, auto col) { return row % 2 == 0 && col % 2 == 0; }));
  for (std::int64_t row = 0; row < spec.rows; row += 2)
    for (std::int64_t col = 0; col < spec.cols; col += 2) expect_slope(slopes.at({row, col}));
}

TEST(Slope, NoneForEmptyBinsForLinesAndForTwoBins) {
  const GridSpec spec = GridSpec::centered(0.5, 0.05);
  const auto on_a_line = [](auto row, auto col) { return row == 10 || (row == 0 && col < 2); };
  std::vector<ReturnPoint> points;
  for (const auto [row, col] : bins_of(spec))
    if (on_a_line(row, col)) points.push_back(on_plane(spec.x(col), spec.y(row)));
  const Grid<Slope> slopes = slope_layer(accumulated(spec, points));
  for (const auto [row, col] : bins_of(spec))
    EXPECT_TRUE(std::isnan(slopes.at({row, col}).x) && std::isnan(slopes.at({row, col}).y))
        << row << ' ' << col;
}

TEST(Slope, ThreeBinsOffALineSuffice) {
  const GridSpec spec = GridSpec::centered(0.5, 0.05);
  const Grid<Slope> slopes = slope_layer(scattered(spec, [](auto row, auto col) {
    return (row == 10 && col == 10) || (row == 12 && col == 10) || (row == 11 && col == 12);
  }));
  expect_slope(slopes.at({10, 10}));
}

/// The slope in bin (10, 10), m per bin edge, of single returns in the centres of bins; z is that of the
/// plane x - 2 y for those within `flat` bins of it, and of another plane farther out.
Slope slope_of(const std::vector<BinIndex>& filled, std::int64_t flat) {
  const GridSpec spec = GridSpec::centered(10, 1);
  std::vector<ReturnPoint> points;
  for (const BinIndex bin : filled) {
    const double x = spec.x(bin.col);
    const double y = spec.y(bin.row);
    const bool near = std::max(std::abs(x), std::abs(y)) <= static_cast<double>(flat);
    points.push_back({.x_est = x, .y_est = y, .z_est = near ? x - 2 * y : 5 * x + 9 * y});
  }
  return slope_layer(accumulated(spec, points)).at({10, 10});
}

TEST(Slope, SixBinsAreEnoughAndFiveAreNot) {
  std::vector<BinIndex> bins = {{10, 10}, {9, 9}, {9, 11}, {11, 9}, {12, 12}, {8, 9}};
  EXPECT_GT(std::abs(slope_of(bins, 1).x - 1), 0.1);  // four of the 3 x 3 and those farther out
  bins.push_back({11, 11});
  EXPECT_GT(std::abs(slope_of(bins, 1).x - 1), 0.1);
  bins.push_back({10, 9});
  EXPECT_FLOAT_EQ(slope_of(bins, 1).x, 1);
  EXPECT_FLOAT_EQ(slope_of(bins, 1).y, -2);
  // The same of the 5 x 5.
  bins = {{10, 10}, {8, 8}, {12, 8}, {8, 12}, {12, 12}, {13, 12}, {7, 9}};
  EXPECT_GT(std::abs(slope_of(bins, 2).x - 1), 0.1);
  bins.push_back({10, 12});
  EXPECT_FLOAT_EQ(slope_of(bins, 2).x, 1);
}

TEST(Slope, ThreeBinsWithinThreeAreTheLeast) {
  const std::vector<BinIndex> three = {{10, 10}, {13, 10}, {11, 7}};
  EXPECT_FLOAT_EQ(slope_of(three, 3).x, 1);
  EXPECT_FLOAT_EQ(slope_of(three, 3).y, -2);
  EXPECT_TRUE(std::isnan(slope_of({{10, 10}, {13, 10}, {11, 6}}, 9).x));  // four bins away
  EXPECT_TRUE(std::isnan(slope_of({{10, 10}, {11, 7}}, 9).x));
}

// Two rows of three bins, the centroids d bins apart: they scatter by (d / 2)^2 across.
TEST(Slope, NoneWhereCentroidsScatterByLessThanATenth) {
  const auto two_rows = [](double d) {
    std::vector<ReturnPoint> points;
    for (const double x : {-1.0, 0.0, 1.0})
      for (const double y : {0.5 - d / 2, 0.5 + d / 2})
        points.push_back({.x_est = x, .y_est = y, .z_est = y});
    return slope_layer(accumulated(GridSpec::centered(4, 1), points)).at({4, 4});
  };
  EXPECT_TRUE(std::isnan(two_rows(0.62).y));  // 0.0961
  EXPECT_FLOAT_EQ(two_rows(0.64).y, 1);       // 0.1024
}

// sigma_z / (s sqrt(6)) on each axis: 3 x 3 bins, returns in the centres. 2401 independent windows: the
// standard deviation is known to 1 / sqrt(2 * 2401) = 1.4 %; 6 % is 4 sigma (false alarm 1e-4, fixed seed).
TEST(Slope, NoiseOfTheSlope) {
  constexpr double kSigma = 0.01;
  const GridSpec spec = GridSpec::centered(3.65, 0.05);  // 147 x 147
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, kSigma);
  std::vector<ReturnPoint> points;
  for (const auto [row, col] : bins_of(spec))
    points.push_back({.x_est = spec.x(col), .y_est = spec.y(row), .z_est = noise(random)});
  const Grid<Slope> slopes = slope_layer(accumulated(spec, points));
  double sum = 0;
  int count = 0;
  for (std::int64_t row = 1; row < spec.rows; row += 3)
    for (std::int64_t col = 1; col < spec.cols; col += 3) {
      sum += double{slopes.at({row, col}).x} * slopes.at({row, col}).x;
      ++count;
    }
  EXPECT_EQ(count, 2401);
  EXPECT_NEAR(std::sqrt(sum / count) / (kSigma / (0.05 * std::sqrt(6.0))), 1, 0.06);
}

Grid<double> corrected_layer(const WeightedMeanAccumulator& bins) {
  const Grid<Slope> slopes = slope_layer(bins);
  const std::vector<BinValues> values = all_values(bins);
  const GridSpec& spec = bins.spec();
  Grid<double> corrected(spec);
  for (const BinIndex bin : bins_of(spec))
    corrected.at(bin) = corrected_elevation(values[spec.index(bin)], spec, bin, slopes.at(bin));
  return corrected;
}

// The error of Eq. 13 is gone.
TEST(Corrected, OnAPlaneItIsThePlaneAtTheBinsCentre) {
  const GridSpec spec = GridSpec::centered(0.25, 0.05);
  const WeightedMeanAccumulator bins =
      scattered(spec, [](auto row, auto col) { return row != 3 || col != 4; });
  const Grid<double> corrected = corrected_layer(bins);
  for (const auto [row, col] : bins_of(spec)) {
    if (row == 3 && col == 4)
      EXPECT_TRUE(std::isnan(corrected.at({row, col})));
    else
      EXPECT_NEAR(corrected.at({row, col}), plane(spec.x(col), spec.y(row)), 2e-6);
  }
}

TEST(Corrected, NanWithoutASlope) {
  const WeightedMeanAccumulator bins = accumulated(GridSpec::centered(1, 1), {{.x_est = 0.25, .z_est = 4}});
  EXPECT_TRUE(std::isnan(corrected_layer(bins).at({1, 1})));
}

}  // namespace
}  // namespace landfall
