// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/receiver/range_timer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/core/error.h"

namespace landfall {
namespace {

constexpr double kTimerHalfLight_mps = 149896229;

std::vector<double> timed(const RangeTimerParameters& parameters, std::size_t pixels, std::int64_t pulse = 0,
                          double range_m = 500, std::int64_t number = 0) {
  std::vector<double> ranges(pixels, range_m);
  RangeTimer(parameters, pixels, 7).apply(pulse, number, ranges);
  return ranges;
}

double standard_deviation(const std::vector<double>& values, double mean) {
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(RangeTimer, IsOffByDefault) {
  EXPECT_FALSE(RangeTimer().is_on());
  EXPECT_EQ(timed({}, 3), (std::vector<double>{500, 500, 500}));
}

TEST(RangeTimer, RoundsToTheNearestStep) {
  const double step_m = kTimerHalfLight_mps * 0.5e-9;
  for (const double steps : {100.0, 6671.4, 6671.6, 12.5001})
    EXPECT_NEAR(timed({.timer_step_s = 0.5e-9}, 1, 0, steps * step_m)[0], std::round(steps) * step_m, 1e-9)
        << steps;
}

TEST(RangeTimer, AFastClockCountsMore) { EXPECT_NEAR(timed({.clock_scale_ppm = 20}, 1)[0], 500.01, 1e-12); }

TEST(RangeTimer, EveryPixelKeepsItsOffset) {
  const RangeTimerParameters offsets{.pixel_offset_sigma_m = 0.02};
  const std::vector<double> first = timed(offsets, 20000, 0);
  EXPECT_EQ(timed(offsets, 20000, 17), first);
  EXPECT_EQ(timed(offsets, 20000, 17, 500, 2), first);
  EXPECT_NEAR(standard_deviation(first, 500), 0.02, 0.0005);
}

TEST(RangeTimer, EveryPixelHasTheOffsetThatIsGiven) {
  EXPECT_EQ(timed({.pixel_offset_m = {0.25, 0, -0.5}}, 3), (std::vector<double>{500.25, 500, 499.5}));
}

TEST(RangeTimer, JitterIsWhite) {
  const RangeTimerParameters jitter{.jitter_sigma_s = 1e-10};
  const std::vector<double> first = timed(jitter, 20000, 0);
  EXPECT_NEAR(standard_deviation(first, 500), kTimerHalfLight_mps * 1e-10, 4e-4);
  EXPECT_NE(timed(jitter, 20000, 1)[0], first[0]);
  EXPECT_NE(timed(jitter, 20000, 0, 500, 1)[0], first[0]);
}

TEST(RangeTimer, OneTermDoesNotChangeTheDrawsOfAnother) {
  const std::vector<double> jitter = timed({.jitter_sigma_s = 1e-10}, 10);
  const std::vector<double> offset = timed({.pixel_offset_sigma_m = 0.02}, 10);
  const std::vector<double> both = timed({.jitter_sigma_s = 1e-10, .pixel_offset_sigma_m = 0.02}, 10);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_NEAR(both[i], jitter[i] + offset[i] - 500, 1e-12);
}

TEST(RangeTimer, KeepsAMiss) {
  EXPECT_TRUE(std::isnan(timed({1e-10, 0.01, {}, 5, 1e-9}, 1, 0, std::nan(""))[0]));
}

TEST(RangeTimer, NamesABadParameter) {
  EXPECT_THROW(RangeTimer({.jitter_sigma_s = -1}, 1, 1), UsageError);
  EXPECT_THROW(RangeTimer({.pixel_offset_sigma_m = -1}, 1, 1), UsageError);
  EXPECT_THROW(RangeTimer({.clock_scale_ppm = 2e5}, 1, 1), UsageError);
  EXPECT_THROW(RangeTimer({.timer_step_s = std::nan("")}, 1, 1), UsageError);
}

}  // namespace
}  // namespace landfall
