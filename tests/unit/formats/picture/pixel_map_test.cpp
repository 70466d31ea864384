// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/picture/pixel_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "constants.h"

namespace landfall {
namespace {

/// 1 2 3 / 4 5 6 / 7 8 9, row 0 the southern.
Grid<double> numbers() {
  Grid<double> grid(GridSpec{0.5, -1, -2, 3, 3});
  for (std::size_t i = 0; i < 9; ++i) grid.values()[i] = static_cast<double>(i + 1);
  return grid;
}

TEST(PixelMap, TurnsNorthUpAndKeepsBinsThatFit) {
  const PixelMap map = reduce(numbers(), Reduction::mean, 3);
  EXPECT_EQ(map.values, (std::vector<double>{7, 8, 9, 4, 5, 6, 1, 2, 3}));
  EXPECT_EQ(map.pixel_m, 0.5);
  EXPECT_EQ(map.west_m, -1.25);
  EXPECT_EQ(map.north_m, 0.75);
}

TEST(PixelMap, TakesTheMeanOfWhatHasAValue) {
  Grid<double> grid = numbers();
  grid.at({2, 0}) = kNan;
  const PixelMap map = reduce(grid, Reduction::mean, 2);
  EXPECT_EQ(map.values, (std::vector<double>{(4 + 5 + 8) / 3.0, 7.5, 1.5, 3}));
  EXPECT_EQ(map.pixel_m, 1);
}

TEST(PixelMap, IsTheSameFromStripsInAnyOrder) {
  Grid<double> grid(GridSpec{0.25, -3, 5, 23, 17});
  for (std::size_t i = 0; i < grid.values().size(); ++i)
    grid.values()[i] = i % 7 == 3 ? kNan : static_cast<double>(i * i % 101);
  for (const Reduction reduction : {Reduction::mean, Reduction::greatest}) {
    LayerReducer reducer(grid.spec(), reduction, 6);
    for (const std::int64_t first : {16, 0, 8}) {
      const std::int64_t rows = std::min<std::int64_t>(8, 23 - first);
      Grid<double> strip(GridSpec{0.25, first - 3, 5, rows, 17});
      for (std::int64_t row = 0; row < rows; ++row)
        std::ranges::copy(grid.row(first + row), strip.row(row).begin());
      reducer.add(strip);
    }
    const PixelMap whole = reduce(grid, reduction, 6);
    const PixelMap strips = reducer.map();
    ASSERT_EQ(strips.values.size(), 6U * 5U);
    for (std::size_t i = 0; i < whole.values.size(); ++i) EXPECT_EQ(strips.values[i], whole.values[i]) << i;
  }
}

TEST(PixelMap, LosesNoFlag) {
  Grid<std::int8_t> grid(GridSpec{1, 0, 0, 5, 5}, 0);
  grid.at({3, 1}) = 16;
  EXPECT_EQ(reduce(grid, Reduction::greatest, 1).values, (std::vector<double>{16}));
  Grid<float> holes(GridSpec{1, 0, 0, 2, 2}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(std::isnan(reduce(holes, Reduction::greatest, 1).values.front()));
}

TEST(PointMap, GathersMeansAndCounts) {
  PointMap map({0, 4, 0, 2}, 32, 1000);  // 4 of 32 points per pixel: 4 x 2 pixels of 1 m
  map.add(0.5, 1.5, 10);
  map.add(0.25, 1.25, 20);
  map.add(4, 0, 7);  // on the border
  map.add(9, -9, 9);
  const PixelMap mean = map.values();
  ASSERT_EQ(mean.rows, 2);
  ASSERT_EQ(mean.cols, 4);
  EXPECT_EQ(mean.at(0, 0), 15);
  EXPECT_TRUE(std::isnan(mean.at(0, 1)));
  EXPECT_EQ(mean.at(1, 3), 8);
  EXPECT_EQ(map.count().at(1, 3), 2);
}

TEST(PointMap, KeepsTheGreatest) {
  PointMap map({0, 1, 0, 1}, 4, 1000, Reduction::greatest);
  for (const double value : {-3, -1, -2}) map.add(0.5, 0.5, value);
  EXPECT_EQ(map.values().values, (std::vector<double>{-1}));
}

TEST(PointMap, HoldsPointsOnOneSpot) {
  PointMap map({3, 3, 5, 5}, 2, 1000);
  map.add(3, 5, 1);
  map.add(3, 5, 3);
  EXPECT_EQ(map.values().values, (std::vector<double>{2}));
}

/// A plane z = east x + north y.
PixelMap plane(double east, double north) {
  PixelMap map{5, 5, 1, 0, 5, {}};
  for (int row = 0; row < 5; ++row)
    for (int col = 0; col < 5; ++col) map.values.push_back(east * col - north * row);
  return map;
}

TEST(Relief, IsOneOnLevelGroundAndDarkAwayFromTheLight) {
  for (const double shade : hillshade(plane(0, 0))) EXPECT_EQ(shade, 1);
  // A slope of 0.4 up to the east faces west, to the light; the closed form with the normal (-0.4, 0, 1).
  const double lit = (0.4 + std::sqrt(2.0)) / std::sqrt(2.0 * 1.16);
  for (const double shade : hillshade(plane(0.4, 0))) EXPECT_NEAR(shade, lit, 1e-12);
  const double dark = (-0.4 + std::sqrt(2.0)) / std::sqrt(2.0 * 1.16);
  for (const double shade : hillshade(plane(0, 0.4))) EXPECT_NEAR(shade, dark, 1e-12);
}

TEST(Relief, LeavesOutWhatHasNoValue) {
  PixelMap map = plane(0.4, 0);
  map.values[12] = kNan;
  const double lit = (0.4 + std::sqrt(2.0)) / std::sqrt(2.0 * 1.16);
  const std::vector<double> shades = hillshade(map);
  for (std::size_t i = 0; i < 25; ++i) EXPECT_NEAR(shades[i], i == 12 ? 1 : lit, 1e-12);
}

}  // namespace
}  // namespace landfall
