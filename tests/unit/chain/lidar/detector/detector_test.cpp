// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/detector.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/core/error.h"

namespace landfall {
namespace {

using Directions = std::vector<Direction<LidarFrame>>;

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

TEST(Detector, KeepsItsEstimator) {
  std::vector<double> ranges = {3, 1, 8};
  EXPECT_EQ(Detector({1, 1, 1}, Directions(1), {}).estimator().range_m(ranges), 4);
  const Detector detector({1, 1, 1}, Directions(1), {}, RangeEstimator({.rule = RangeRule::first}));
  EXPECT_EQ(detector.estimator().range_m(ranges), 1);
}

}  // namespace
}  // namespace landfall
