// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/range_estimator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/core/error.h"
#include "constants.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

using enum RangeRule;
constexpr std::array kRules = {mean, first, median, strongest};

double range_of(RangeRule rule, std::vector<double> ranges, double resolution_m = 0.15) {
  return RangeEstimator({rule, resolution_m}).range_m(ranges);
}

TEST(RangeEstimator, OneSampleIsItself) {
  for (const RangeRule rule : kRules) {
    EXPECT_EQ(range_of(rule, {0.1}), 0.1);
    EXPECT_TRUE(std::isnan(range_of(rule, {kNan})));
  }
}

TEST(RangeEstimator, NoSamplesIsNoReturn) {
  for (const RangeRule rule : kRules) EXPECT_TRUE(std::isnan(range_of(rule, {})));
}

TEST(RangeEstimator, NoHitIsNoReturn) {
  for (const RangeRule rule : kRules) EXPECT_TRUE(std::isnan(range_of(rule, {kNan, kNan, kNan, kNan})));
}

TEST(RangeEstimator, DefaultIsTheMean) {
  std::vector<double> ranges = {10, kNan, 20, 60};
  EXPECT_EQ(RangeEstimator().range_m(ranges), 30);
}

TEST(RangeEstimator, MeanOfThoseThatHit) {
  EXPECT_EQ(range_of(mean, {10, 20, 60, 30}), 30);
  EXPECT_EQ(range_of(mean, {10, kNan, 20, 60}), 30);
}

// The bits of a mean depend on the order of its sum.
TEST(RangeEstimator, MeanSumsInTheOrderGiven) {
  EXPECT_EQ(range_of(mean, {0.1, 0.2, 0.3}), (0.1 + 0.2 + 0.3) / 3);
  EXPECT_EQ(range_of(mean, {0.3, 0.2, 0.1}), (0.3 + 0.2 + 0.1) / 3);
  EXPECT_NE((0.1 + 0.2 + 0.3) / 3, (0.3 + 0.2 + 0.1) / 3);
}

TEST(RangeEstimator, MeanAndMedianNeedHalf) {
  for (const RangeRule rule : {mean, median}) {
    EXPECT_EQ(range_of(rule, {10, kNan, kNan, 20}), 15);
    EXPECT_TRUE(std::isnan(range_of(rule, {10, kNan, kNan, kNan})));
    EXPECT_EQ(range_of(rule, {1, 2, 3, 4, 5, kNan, kNan, kNan, kNan}), 3);
    EXPECT_TRUE(std::isnan(range_of(rule, {1, 2, 3, 4, kNan, kNan, kNan, kNan, kNan})));
  }
}

TEST(RangeEstimator, FirstAndStrongestNeedOne) {
  for (const RangeRule rule : {first, strongest}) EXPECT_EQ(range_of(rule, {kNan, kNan, kNan, 7}), 7);
}

TEST(RangeEstimator, FirstIsTheNearest) { EXPECT_EQ(range_of(first, {30, kNan, 10, 20}), 10); }

TEST(RangeEstimator, MedianOfEvenCountIsTheMiddleTwosMean) {
  EXPECT_EQ(range_of(median, {40, 10, 20, 90}), 30);
  EXPECT_EQ(range_of(median, {90, 10, 20}), 20);
}

TEST(RangeEstimator, StrongestIsTheDensestCluster) {
  EXPECT_EQ(range_of(strongest, {50, 10, 50.125, 10, 50}, 0.125), (50 + 50 + 50.125) / 3);
  EXPECT_EQ(range_of(strongest, {50, 10, 50.125, 10, 50}, 0.0625), 10);  // two each: the nearest
}

TEST(RangeEstimator, StrongestsWindowIsClosedAndBesideItNothingCounts) {
  EXPECT_EQ(range_of(strongest, {1, 2, 3, 4}, 1), 1.5);
  EXPECT_EQ(range_of(strongest, {1, 2, 3, 4}, 0.99), 1);
  EXPECT_EQ(range_of(strongest, {1, 2, 3, 4}, 3), 2.5);
}

// A step of 1 m that covers a quarter of the pixel: each rule's answer is known.
TEST(RangeEstimator, OverAStep) {
  const std::vector<double> step = {99, 100, 100, 100};
  EXPECT_EQ(range_of(mean, step), 99.75);
  EXPECT_EQ(range_of(first, step), 99);
  EXPECT_EQ(range_of(median, step), 100);
  EXPECT_EQ(range_of(strongest, step), 100);
}

TEST(RangeEstimator, RefusesAResolutionOutOfRange) {
  for (const double bad : {0.0, -0.1, kNan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(RangeEstimator({strongest, bad}), UsageError);
  EXPECT_THAT(refusal([&] {
                return RangeEstimator({strongest, -1});
              }),
              testing::HasSubstr("range_resolution_m: -1 is not finite"));
}

/// The rule by trying every window.
double slow_strongest(std::vector<double> ranges, double width) {
  std::erase_if(ranges, [](double r) { return std::isnan(r); });
  std::sort(ranges.begin(), ranges.end());
  std::vector<double> best;
  for (const double from : ranges) {
    std::vector<double> inside;
    std::copy_if(ranges.begin(), ranges.end(), std::back_inserter(inside),
                 [&](double r) { return r >= from && r - from <= width; });
    if (inside.size() > best.size()) best = inside;
  }
  double sum = 0;
  for (const double r : best) sum += r;
  return sum / static_cast<double>(best.size());
}

TEST(RangeEstimator, RandomSamples) {
  std::mt19937_64 random(test_seed());
  for (int round = 0; round < 2000; ++round) {
    std::vector<double> ranges(1 + random() % 16);
    for (double& range : ranges)
      range = random() % 5 == 0 ? kNan : 100 + 0.05 * static_cast<double>(random() % 20);
    std::vector<double> shuffled = ranges;
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (const RangeRule rule : {first, median, strongest}) {
      const double range = range_of(rule, ranges);
      const double again = range_of(rule, shuffled);
      EXPECT_TRUE(range == again || (std::isnan(range) && std::isnan(again)));
      // One that does report lies among those that hit.
      if (!std::isnan(range)) {
        EXPECT_GE(range, range_of(first, ranges) - 1e-12);
        EXPECT_LE(range, 101);
      }
    }
    if (std::isnan(range_of(first, ranges))) continue;
    EXPECT_EQ(range_of(strongest, ranges, 0.12), slow_strongest(ranges, 0.12));
  }
}

}  // namespace
}  // namespace landfall
