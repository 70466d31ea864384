// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "chain/lidar/detector/detector.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/detector/pixel_table.h"
#include "chain/lidar/detector/range_estimator.h"
#include "constants.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Directions = std::vector<Direction<LidarFrame>>;
using Rows = std::vector<std::array<double, 4>>;
using enum RangeRule;

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

TEST(RadialDistortion, FactorIsThePolynomial) {
  EXPECT_EQ((RadialDistortion{}.factor(0.7)), 1);
  EXPECT_EQ((RadialDistortion{2, 4, 8}.factor(0.5)), 1 + 1 + 1 + 1);
}

// r - r^3 / 3 turns at r = 1; r + k2 r^5 and r + k3 r^7 at (-5 k2)^(-1/4) and (-7 k3)^(-1/6).
TEST(FoldRadius, ClosedForms) {
  EXPECT_NEAR(fold_radius({-1.0 / 3, 0, 0}, 2).value(), 1, 1e-12);
  EXPECT_NEAR(fold_radius({0, -0.1, 0}, 2).value(), std::pow(0.5, -0.25), 1e-12);
  EXPECT_NEAR(fold_radius({0, 0, -3}, 2).value(), std::pow(21, -1.0 / 6), 1e-12);
  // 1 - 5 s / 2 + s^2 has the roots 1/2 and 2.
  EXPECT_NEAR(fold_radius({-2.5 / 3, 0.2, 0}, 10).value(), std::sqrt(0.5), 1e-12);
  // The image folds and unfolds before the end: a root that is not the last one.
  EXPECT_NEAR(fold_radius({-2.5 / 3, 0.2, 1e-9}, 10).value(), std::sqrt(0.5), 1e-8);
}

TEST(FoldRadius, NoneWithoutOrBelowTheFold) {
  EXPECT_FALSE(fold_radius({}, 100));
  EXPECT_FALSE(fold_radius({0.5, 0.1, 0.3}, 100));
  EXPECT_FALSE(fold_radius({-1.0 / 3, 0, 0}, 0.999999));
  EXPECT_TRUE(fold_radius({-1.0 / 3, 0, 0}, 1.000001));
  EXPECT_FALSE(fold_radius({-1.0 / 3, 0.3, 0}, 100));
}

// Against a walk along the radius.
TEST(FoldRadius, RandomCoefficients) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> k(-1, 1);
  int folded = 0;
  for (int round = 0; round < 300; ++round) {
    const RadialDistortion d{k(random), k(random), k(random)};
    constexpr double kStep = 1e-3;
    double walked = 0;
    const auto distorted = [&](double r) { return r * d.factor(r * r); };
    while (walked < 1.5 && distorted(walked + kStep) > distorted(walked)) walked += kStep;
    const auto fold = fold_radius(d, 1.5);
    EXPECT_EQ(fold.has_value(), walked < 1.5 - kStep) << d.k1 << ' ' << d.k2 << ' ' << d.k3;
    if (fold) {
      EXPECT_NEAR(*fold, walked, 2 * kStep);
      ++folded;
    }
  }
  EXPECT_GT(folded, 50);
  EXPECT_LT(folded, 250);
}

NumberTable table_of(const Rows& rows) {
  std::map<std::string, std::vector<double>> columns{{"row", {}}, {"column", {}}, {"u", {}}, {"v", {}}};
  for (const auto& [row, column, u, v] : rows) {
    columns["row"].push_back(row);
    columns["column"].push_back(column);
    columns["u"].push_back(u);
    columns["v"].push_back(v);
  }
  return {"pixels.csv", std::move(columns)};
}

void expect_refused(const Rows& table, const std::string& words) {
  EXPECT_THAT(refusal<FormatError>([&] { return pixel_points(table_of(table), 2, 2); }),
              testing::StartsWith("pixels.csv: " + words));
}

const Rows kWhole = {{1, 1, 4, 5}, {0, 0, -1, -2}, {0, 1, 2, 3}, {1, 0, 6, 7}};

TEST(PixelTable, AnyOrderOfRows) {
  EXPECT_EQ(pixel_points(table_of(kWhole), 2, 2),
            (std::vector<ImagePoint>{{-1, -2}, {2, 3}, {6, 7}, {4, 5}}));
}

TEST(PixelTable, LineArrays) {
  EXPECT_EQ(pixel_points(table_of({{0, 1, 1, 0}, {0, 0, 2, 0}, {0, 2, 3, 0}}), 1, 3),
            (std::vector<ImagePoint>{{2, 0}, {1, 0}, {3, 0}}));
}

TEST(PixelTable, EveryPixelExactlyOnce) {
  expect_refused({kWhole.begin(), kWhole.begin() + 3}, "pixel (row 1, column 0) has no row");
  expect_refused({}, "pixel (row 0, column 0) has no row");
  Rows twice = kWhole;
  twice.push_back(kWhole[2]);
  expect_refused(twice, "row 5: pixel (row 0, column 1) has a row already");
}

TEST(PixelTable, OnlyPixelsOfTheDetector) {
  const auto with = [](double row, double column) {
    Rows table = kWhole;
    table[1][0] = row;
    table[1][1] = column;
    return table;
  };
  expect_refused(with(2, 0), "row 2: row 2 is not one of 0..1");
  expect_refused(with(-1, 0), "row 2: row -1 is not one of 0..1");
  expect_refused(with(0.5, 0), "row 2: row 0.5 is not");
  expect_refused(with(0, 2), "row 2: column 2 is not one of 0..1");
  expect_refused(with(0, std::numeric_limits<double>::quiet_NaN()), "row 2: column nan is not");
}

TEST(PixelTable, PlacesMustBeFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Rows table = kWhole;
    table[2][2] = bad;
    expect_refused(table, "row 3: u and v must be finite");
    table[2] = {0, 1, 0, bad};
    expect_refused(table, "row 3: u and v must be finite");
  }
}

TEST(PixelOffsets, OneRowPerPixelInAnyOrder) {
  const auto offsets_of = [](std::vector<double> rows, std::vector<double> offsets) {
    return pixel_offsets_m(
        {"offsets.csv", {{"row", std::move(rows)}, {"column", {1, 0}}, {"offset_m", std::move(offsets)}}}, 1,
        2);
  };
  EXPECT_EQ(offsets_of({0, 0}, {0.02, -0.01}), (std::vector<double>{-0.01, 0.02}));
  EXPECT_THROW(static_cast<void>(offsets_of({0, 1}, {0.02, -0.01})), FormatError);
  EXPECT_THROW(static_cast<void>(offsets_of({0, 0}, {0.02, std::numeric_limits<double>::infinity()})),
               FormatError);
}

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
