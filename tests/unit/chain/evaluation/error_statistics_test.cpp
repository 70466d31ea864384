// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/error_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "chain/evaluation/piecewise.h"
#include "constants.h"

namespace landfall {
namespace {

Grid<double> metre_row(std::initializer_list<double> values) {
  Grid<double> grid(GridSpec{1, 0, 0, 1, static_cast<std::int64_t>(values.size())});
  std::copy(values.begin(), values.end(), grid.values().begin());
  return grid;
}

// In the region 1 2 3 6 and a NaN: mean 3, deviations -2 -1 0 3, median 2.5, |e - median| 0.5 0.5 1.5 3.5.
TEST(ErrorStatistics, ByHand) {
  const Grid<double> error = metre_row({100, 1, kNan, 6, 2, 3, -100});
  BinMask region(error.spec(), 1);
  region.values().front() = region.values().back() = 0;
  const ErrorStatistics statistics = error_statistics(error, region);
  EXPECT_EQ(statistics.count, 4);
  EXPECT_EQ(statistics.mean_m, 3);
  EXPECT_DOUBLE_EQ(statistics.std_m.value(), std::sqrt(14.0 / 4));
  EXPECT_DOUBLE_EQ(statistics.rmse_m.value(), std::sqrt(50.0 / 4));
  EXPECT_EQ(statistics.median_m, 2.5);
  EXPECT_DOUBLE_EQ(statistics.nmad_m.value(), 1.4826 * 1);
  EXPECT_NEAR(statistics.le90_m.value(), 3 + 0.7 * 3, 1e-14);  // h = 2.7
  EXPECT_NEAR(statistics.p95_m.value(), 3 + 0.85 * 3, 1e-14);  // h = 2.85
}

TEST(ErrorStatistics, QuantilesOfMagnitudesAreNotThoseOfErrors) {
  const ErrorStatistics statistics =
      error_statistics(metre_row({-10, 0, 1}), BinMask(GridSpec{1, 0, 0, 1, 3}, 1));
  EXPECT_EQ(statistics.median_m, 0);
  EXPECT_NEAR(statistics.le90_m.value(), 1 + 0.8 * 9, 1e-14);
}

TEST(ErrorStatistics, WithoutAnErrorOnlyTheCount) {
  const Grid<double> error = metre_row({kNan, 5});
  BinMask region(error.spec());
  region.at({0, 0}) = 1;
  EXPECT_EQ(error_statistics(error, region), ErrorStatistics{.count = 0});
  EXPECT_EQ(horizontal_statistics(error, region), HorizontalStatistics{.count = 0});
}

// A normal distribution: NMAD and standard deviation agree, LE90 is 1.645 sigma, CE90 of two such errors
// 2.146 sigma. Bounds: five standard errors of each estimate at 360,000 values.
TEST(ErrorStatistics, NormalErrors) {
  const GridSpec spec{1, 0, 0, 600, 600};
  const RandomField noise(11, RandomStream::range_noise);
  Grid<double> error(spec);
  Grid<double> horizontal(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    error.values()[i] = 0.02 + 0.5 * noise.normal(i, 0);
    horizontal.values()[i] = std::hypot(0.5 * noise.normal(i, 1), 0.5 * noise.normal(i, 2));
  }
  const BinMask everywhere(spec, 1);
  const ErrorStatistics statistics = error_statistics(error, everywhere);
  EXPECT_NEAR(statistics.mean_m.value(), 0.02, 0.0042);
  EXPECT_NEAR(statistics.std_m.value(), 0.5, 0.003);
  EXPECT_NEAR(statistics.nmad_m.value(), 0.5, 0.005);
  EXPECT_NEAR(statistics.le90_m.value(), 1.645 * 0.5, 0.013);
  EXPECT_NEAR(horizontal_statistics(horizontal, everywhere).ce90_m.value(), 2.146 * 0.5, 0.013);
  EXPECT_NEAR(horizontal_statistics(horizontal, everywhere).rmse_m.value(), std::sqrt(0.5), 0.004);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(error_statistics(error, everywhere), statistics);
  }
}

// Squares of the errors themselves would lose what is left beside them.
TEST(ErrorStatistics, DeviationsBesideALargeMean) {
  const ErrorStatistics statistics =
      error_statistics(metre_row({1e9 - 1, 1e9, 1e9 + 1}), BinMask(GridSpec{1, 0, 0, 1, 3}, 1));
  EXPECT_EQ(statistics.mean_m, 1e9);
  EXPECT_DOUBLE_EQ(statistics.std_m.value(), std::sqrt(2.0 / 3));
}

// Values are taken in pieces; the last one is full, holds one value, or holds but one that counts.
TEST(ErrorStatistics, WholePiecesAndOneMore) {
  for (const std::size_t more : {0U, 1U}) {
    const GridSpec spec{1, 0, 0, 1, static_cast<std::int64_t>(kValuesPerPiece + more)};
    Grid<double> error(spec, kNan);
    error.values().front() = 1;
    error.values()[kValuesPerPiece - 1] = -2;
    error.values().back() = -5;
    const ErrorStatistics statistics = error_statistics(error, BinMask(spec, 1));
    EXPECT_EQ(statistics.count, 2 + more);
    EXPECT_EQ(statistics.median_m, -2.0);
    EXPECT_EQ(statistics.mean_m, -2.0);
    EXPECT_DOUBLE_EQ(statistics.nmad_m.value(), 1.4826 * 3);
    EXPECT_NEAR(statistics.le90_m.value(), more == 0 ? 4.6 : 4.4, 1e-14);
    EXPECT_EQ(horizontal_statistics(error, BinMask(spec, 1)).count, 2 + more);
  }
}

}  // namespace
}  // namespace landfall
