// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/accuracy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "constants.h"

namespace landfall {
namespace {

Grid<double> row_of(std::initializer_list<double> values) {
  Grid<double> grid(GridSpec{0.5, 2, -1, 1, static_cast<std::int64_t>(values.size())});
  std::copy(values.begin(), values.end(), grid.values().begin());
  return grid;
}

// Bins at x = -0.5, 0, 0.5 and y = 1.
TEST(ErrorOf, TruthMinusEstimate) {
  const Grid<double> z_est = row_of({11, kNan, 29.5});
  const Grid<double> x = error_of(Axis::x, row_of({-0.25, 0, kNan}), z_est);
  EXPECT_EQ(x.at({0, 0}), 0.25);
  EXPECT_EQ(x.at({0, 1}), 0);
  EXPECT_TRUE(std::isnan(x.at({0, 2})));
  const Grid<double> y = error_of(Axis::y, row_of({1.5, 0.75, 1}), z_est);
  EXPECT_EQ(y.at({0, 0}), 0.5);
  EXPECT_EQ(y.at({0, 1}), -0.25);
  const Grid<double> z = error_of(Axis::z, row_of({10, 20, 30}), z_est);
  EXPECT_EQ(z.at({0, 0}), -1);
  EXPECT_TRUE(std::isnan(z.at({0, 1})));
  EXPECT_EQ(z.at({0, 2}), 0.5);
}

// Bins outside the region count in a footprint; only footprints centred inside have a value.
TEST(FootprintStatistics, CentredInTheRegion) {
  const Grid<double> error = row_of({3, 6, 0, 9});
  BinMask region(error.spec());
  region.at({0, 1}) = 1;
  const FootprintStatistics statistics = footprint_statistics(error, region, {Footprint::square(1), 0.5});
  EXPECT_EQ(statistics.mean.at({0, 1}), 3);
  EXPECT_EQ(statistics.relative.at({0, 1}), 3);  // deviations 0 3 3
  for (const std::int64_t outside : {0, 2, 3}) {
    EXPECT_TRUE(std::isnan(statistics.mean.at({0, outside})));
    EXPECT_TRUE(std::isnan(statistics.relative.at({0, outside})));
  }
}

TEST(Errors, OfAllLayers) {
  const Grid<double> z_est = row_of({1, kNan, 3});
  const TrueLayers truth{row_of({5, 6, 7}), row_of({1, 2, 3}), row_of({10, 20, 31})};
  const ErrorLayers plain = errors_of(truth, z_est);
  EXPECT_FALSE(plain.z_corrected);
  const ErrorLayers errors = errors_of(truth, z_est, row_of({9, 18, kNan}));
  for (const ErrorLayers* const e : {&plain, &errors}) {
    EXPECT_EQ(e->x.at({0, 1}), error_of(Axis::x, truth.x, z_est).at({0, 1}));
    EXPECT_EQ(e->y.at({0, 2}), error_of(Axis::y, truth.y, z_est).at({0, 2}));
    EXPECT_EQ(e->z.at({0, 0}), 9);
    EXPECT_TRUE(std::isnan(e->z.at({0, 1})));
    EXPECT_EQ(e->z.at({0, 2}), 28);
  }
  EXPECT_EQ(errors.z_corrected->at({0, 0}), 1);
  EXPECT_EQ(errors.z_corrected->at({0, 1}), 2);
  EXPECT_TRUE(std::isnan(errors.z_corrected->at({0, 2})));
}

TEST(FootprintStatistics, TheQuantileIsThatOfThePaper) {
  EXPECT_EQ(FootprintRule{Footprint::square(0)}.quantile, 0.95);
  const Grid<double> error = row_of({3, 6, 0, 9});
  const BinMask everywhere(error.spec(), 1);
  const FootprintStatistics statistics = footprint_statistics(error, everywhere, {Footprint::square(2)});
  EXPECT_EQ(statistics.relative.at({0, 1}), 4.5);  // about the mean of 4.5: 1.5 1.5 4.5 4.5
}

TEST(Summaries, Absolute) {
  const AbsoluteMetrics metrics = summarise_absolute(row_of({kNan, -4, 1, 0, kNan}));
  EXPECT_EQ(metrics.mean_m, -1);
  EXPECT_EQ(metrics.max_m, 4);
  // The values are 0, 1, 4: h = 1.9.
  EXPECT_NEAR(metrics.p95_m.value(), 1 + 0.9 * 3, 1e-14);
  EXPECT_EQ(summarise_absolute(row_of({kNan})), AbsoluteMetrics{});
}

TEST(Summaries, Relative) {
  const RelativeMetrics metrics = summarise_relative(row_of({0.25, kNan, 0.5, 0.75}), 0.25);
  EXPECT_EQ(metrics.max_m, 0.75);
  EXPECT_EQ(metrics.violation_count, 2);  // equal to the limit is none
  EXPECT_NEAR(metrics.p95_m.value(), 0.725, 1e-14);
  EXPECT_EQ(summarise_relative(row_of({kNan}), 0), (RelativeMetrics{.violation_count = 0}));
}

TEST(FootprintStatistics, HasNoRelativeErrorWithoutAQuantile) {
  const Grid<double> error = row_of({1, 2, 6});
  const FootprintStatistics found =
      footprint_statistics(error, BinMask(error.spec(), 1), {Footprint::square(1), std::nullopt});
  EXPECT_EQ(found.mean.at({0, 1}), 3);
  for (const double relative : found.relative.values()) EXPECT_TRUE(std::isnan(relative));
}

TEST(Summaries, HorizontalLeavesEmptyFootprintsOut) {
  const Grid<double> horizontal = horizontal_error(row_of({3, 0, 6, kNan}), row_of({4, 1, 8, 0}));
  EXPECT_EQ(horizontal.at({0, 0}), 5);
  EXPECT_TRUE(std::isnan(horizontal.at({0, 3})));
  const HorizontalMetrics metrics = summarise_horizontal(horizontal, 5);
  EXPECT_EQ(metrics.within_limit_frac, 2.0 / 3);
  EXPECT_NEAR(metrics.p95_m.value(), 5 + 0.9 * 5, 1e-14);
  EXPECT_EQ(summarise_horizontal(row_of({kNan}), 1), HorizontalMetrics{});
}

}  // namespace
}  // namespace landfall
