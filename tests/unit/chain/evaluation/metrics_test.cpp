// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "judged.h"

namespace landfall {
namespace {

AccuracyMetrics flawless() {
  AccuracyMetrics accuracy;
  accuracy.footprint_bins = 35;
  accuracy.absolute.horizontal = {.p95_m = 0.5, .within_limit_frac = 1};
  for (RelativeMetrics* axis : {&accuracy.relative.x, &accuracy.relative.y, &accuracy.relative.z})
    *axis = {.p95_m = 0.01, .max_m = 0.02, .violation_count = 0};
  return accuracy;
}

Table1Verdicts verdicts(const CoverageMetrics& coverage, const std::optional<AccuracyMetrics>& accuracy) {
  Metrics metrics;
  metrics.coverage = coverage;
  metrics.accuracy = accuracy;
  return judge(metrics, {});
}

// A metric that was not measured counts nothing.
TEST(Metrics, BeginAtZero) {
  const Metrics metrics;
  EXPECT_EQ(metrics.region.bin_count, 0);
  EXPECT_EQ(metrics.statistics.valid_frac, 0);
  EXPECT_EQ(AccuracyMetrics{}.footprint_bins, 0);
  EXPECT_EQ(AccuracyMetrics{}.quantile, 0);
  EXPECT_EQ(RelativeMetrics{}.violation_count, std::nullopt);
  const ScoreMetrics scores;
  EXPECT_EQ(scores.count, 0);
  EXPECT_EQ(scores.left_out_count, 0);
}

TEST(Judge, FlawlessPasses) {
  const Table1Verdicts judged = verdicts({}, flawless());
  EXPECT_EQ(overall_pass(judged), true);
  EXPECT_EQ(judged["coverage"], (Judged{0.0, 0.01, true}));
  EXPECT_EQ(judged["hole_size"], (Judged{0.0, 10, true}));
  EXPECT_EQ(judged["hole_distance"], (Judged{0.0, 1, true}));
  EXPECT_EQ(judged["relative_elevation"], (Judged{0.0, 0, true}));
  EXPECT_EQ(judged["relative_horizontal"], (Judged{0.0, 0, true}));
  EXPECT_EQ(judged["absolute_horizontal"], (Judged{1.0, 0.95, true}));
}

TEST(Judge, EqualToTheLimitPasses) {
  CoverageMetrics coverage;
  coverage.invalid_frac = 0.01;
  coverage.largest_hole_bins = 10;
  coverage.max_distance_bins = 1;
  AccuracyMetrics accuracy = flawless();
  accuracy.absolute.horizontal.within_limit_frac = 0.95;
  EXPECT_EQ(overall_pass(verdicts(coverage, accuracy)), true);
}

TEST(Judge, JustBeyondTheLimitFails) {
  CoverageMetrics coverage;
  coverage.invalid_frac = std::nextafter(0.01, 1);
  coverage.largest_hole_bins = 11;
  coverage.max_distance_bins = std::sqrt(2.0);
  AccuracyMetrics accuracy = flawless();
  accuracy.absolute.horizontal.within_limit_frac = std::nextafter(0.95, 0);
  const Table1Verdicts judged = verdicts(coverage, accuracy);
  EXPECT_EQ(judged["coverage"].pass, false);
  EXPECT_EQ(judged["hole_size"].pass, false);
  EXPECT_EQ(judged["hole_distance"].pass, false);
  EXPECT_EQ(judged["absolute_horizontal"].pass, false);
  EXPECT_EQ(judged["relative_elevation"].pass, true);
  EXPECT_EQ(overall_pass(judged), false);
}

TEST(Judge, ViolationsOfXAndYAreAdded) {
  AccuracyMetrics accuracy = flawless();
  accuracy.relative.x.violation_count = 2;
  accuracy.relative.y.violation_count = 3;
  const Table1Verdicts judged = verdicts({}, accuracy);
  EXPECT_EQ(judged["relative_horizontal"], (Judged{5.0, 0, false}));
  EXPECT_EQ(judged["relative_elevation"], (Judged{0.0, 0, true}));
  EXPECT_EQ(overall_pass(judged), false);
}

TEST(Judge, WithoutTruthAccuracyIsNull) {
  CoverageMetrics coverage;
  const Table1Verdicts judged = verdicts(coverage, std::nullopt);
  EXPECT_EQ(judged["coverage"].pass, true);
  EXPECT_EQ(judged["relative_elevation"], (Judged{std::nullopt, 0, std::nullopt}));
  EXPECT_EQ(judged["relative_horizontal"], (Judged{std::nullopt, 0, std::nullopt}));
  EXPECT_EQ(judged["absolute_horizontal"], (Judged{std::nullopt, 0.95, std::nullopt}));
  EXPECT_EQ(overall_pass(judged), std::nullopt);
  coverage.invalid_frac = 1;  // a failure does not decide what was not judged
  EXPECT_EQ(overall_pass(verdicts(coverage, std::nullopt)), std::nullopt);
}

TEST(Judge, NoFootprintToJudgeIsNotMet) {
  AccuracyMetrics accuracy;
  accuracy.footprint_bins = 5;
  const Table1Verdicts judged = verdicts({}, accuracy);
  EXPECT_EQ(judged["relative_elevation"], (Judged{std::nullopt, 0, false}));
  EXPECT_EQ(judged["relative_horizontal"], (Judged{std::nullopt, 0, false}));
  EXPECT_EQ(judged["absolute_horizontal"], (Judged{std::nullopt, 0.95, false}));
  EXPECT_EQ(overall_pass(judged), false);
}

TEST(Judge, TooFewBinsAreNotJudged) {
  AccuracyMetrics accuracy = flawless();
  accuracy.footprint_bins = 3;
  accuracy.relative = {};
  Table1Verdicts judged = verdicts({}, accuracy);
  EXPECT_EQ(judged["relative_elevation"], (Judged{std::nullopt, 0, std::nullopt, kFootprintBins}));
  EXPECT_EQ(judged["relative_horizontal"], (Judged{std::nullopt, 0, std::nullopt, kFootprintBins}));
  EXPECT_EQ(judged["absolute_horizontal"], (Judged{1.0, 0.95, true}));
  EXPECT_EQ(overall_pass(judged), std::nullopt);
  judged["coverage"].pass = false;
  EXPECT_EQ(overall_pass(judged), false);
}

TEST(Judge, InfiniteDistanceFails) {
  CoverageMetrics coverage;
  coverage.max_distance_bins = std::numeric_limits<double>::infinity();
  EXPECT_EQ(verdicts(coverage, flawless())["hole_distance"].pass, false);
}

}  // namespace
}  // namespace landfall
