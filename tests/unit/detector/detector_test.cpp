// SPDX-License-Identifier: GPL-3.0-or-later
#include "detector/detector.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using Directions = std::vector<Direction<LidarFrame>>;

double mean_of(std::initializer_list<double> ranges) { return mean_range_m({ranges.begin(), ranges.size()}); }

TEST(MeanRange, OneSampleIsItself) {
  EXPECT_EQ(mean_of({0.1}), 0.1);
  EXPECT_TRUE(std::isnan(mean_of({kNan})));
}

TEST(MeanRange, OfThoseThatHit) {
  EXPECT_EQ(mean_of({10, 20, 60, 30}), 30);
  EXPECT_EQ(mean_of({10, kNan, 20, 60}), 30);
}

TEST(MeanRange, HalfIsEnoughFewerIsNot) {
  EXPECT_EQ(mean_of({10, kNan, kNan, 20}), 15);
  EXPECT_TRUE(std::isnan(mean_of({10, kNan, kNan, kNan})));
  EXPECT_EQ(mean_of({1, 2, 3, 4, 5, kNan, kNan, kNan, kNan}), 3);
  EXPECT_TRUE(std::isnan(mean_of({1, 2, 3, 4, kNan, kNan, kNan, kNan, kNan})));
}

TEST(MeanRange, NoSamplesIsNoReturn) { EXPECT_TRUE(std::isnan(mean_of({}))); }

TEST(Detector, CountsMustFitTheSize) {
  EXPECT_NO_THROW(Detector({2, 3, 1}, Directions(6), {}));
  EXPECT_NO_THROW(Detector({2, 3, 2}, Directions(6), Directions(24)));
  EXPECT_THROW(Detector({2, 3, 1}, Directions(5), {}), UsageError);
  EXPECT_THROW(Detector({2, 3, 2}, Directions(6), {}), UsageError);
  EXPECT_THROW(Detector({2, 3, 2}, Directions(6), Directions(6)), UsageError);
  EXPECT_THROW(Detector({2, 3, 1}, Directions(6), Directions(6)), UsageError);
}

TEST(Detector, IndexIsRowMajor) {
  const Detector detector({2, 3, 1}, Directions(6), {});
  EXPECT_EQ(detector.index({0, 2}), 2U);
  EXPECT_EQ(detector.index({1, 0}), 3U);
}

}  // namespace
}  // namespace landfall
