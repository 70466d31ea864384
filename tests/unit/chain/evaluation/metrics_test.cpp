// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "base/raster/masks.h"
#include "bins.h"
#include "chain/evaluation/accuracy.h"
#include "chain/evaluation/coverage.h"
#include "chain/evaluation/metrics.h"
#include "chain/evaluation/sparse_coverage.h"
#include "constants.h"
#include "judged.h"

namespace landfall {
namespace {

using testing_masks::drawn;

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

Grid<double> row_of(std::initializer_list<double> values) {
  return grid_with({0.5, 2, -1, 1, static_cast<std::int64_t>(values.size())}, values);
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
  EXPECT_FALSE(plain.corrected);
  const ErrorLayers errors = errors_of(truth, z_est, row_of({9, 18, kNan}));
  for (const ErrorLayers* const e : {&plain, &errors}) {
    EXPECT_EQ(e->x.at({0, 1}), error_of(Axis::x, truth.x, z_est).at({0, 1}));
    EXPECT_EQ(e->y.at({0, 2}), error_of(Axis::y, truth.y, z_est).at({0, 2}));
    EXPECT_EQ(e->z.at({0, 0}), 9);
    EXPECT_TRUE(std::isnan(e->z.at({0, 1})));
    EXPECT_EQ(e->z.at({0, 2}), 28);
  }
  EXPECT_EQ(errors.corrected->at({0, 0}), 1);
  EXPECT_EQ(errors.corrected->at({0, 1}), 2);
  EXPECT_TRUE(std::isnan(errors.corrected->at({0, 2})));
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

BinMask all_but(const BinMask& empty) {
  BinMask valid(empty.spec());
  for (std::size_t i = 0; i < empty.spec().size(); ++i) valid.values()[i] = empty.values()[i] != 0 ? 0 : 1;
  return valid;
}

/// The region is the whole drawing.
Coverage coverage_of(std::initializer_list<std::string_view> drawing) {
  const BinMask empty = drawn(drawing);
  return assess_coverage(all_but(empty), BinMask(empty.spec(), 1), {});
}

TEST(Coverage, ABinIsValidIfItHasAnElevation) {
  Grid<double> z({1, 0, 0, 1, 4}, 1.5);
  z.values()[1] = kNan;
  z.values()[2] = 0;
  const BinMask valid = valid_bins(z);
  EXPECT_TRUE(std::ranges::equal(valid.values(), std::vector<std::int8_t>{1, 0, 1, 1}));
}

TEST(Coverage, FullDem) {
  const CoverageMetrics metrics = coverage_of({"...", "..."}).metrics;
  EXPECT_EQ(metrics, CoverageMetrics{});
}

TEST(Coverage, DistancesWithinHolesOfTwoByTwoThreeByThreeAndAPlus) {
  const Coverage two = coverage_of({"....", ".##.", ".##.", "...."});
  EXPECT_EQ(two.metrics.invalid_count, 4);
  EXPECT_EQ(two.metrics.invalid_frac, 0.25);
  EXPECT_EQ(two.metrics.max_distance_bins, 1);
  EXPECT_EQ(two.metrics.distance_over_limit_count, 0);
  const Coverage three = coverage_of({".....", ".###.", ".###.", ".###.", "....."});
  EXPECT_EQ(three.metrics.max_distance_bins, 2);
  EXPECT_EQ(three.metrics.distance_over_limit_count, 1);
  EXPECT_EQ(three.squared_distance.at({2, 2}), 4);
  EXPECT_EQ(three.squared_distance.at({1, 1}), 1);
  const Coverage plus = coverage_of({".....", "..#..", ".###.", "..#..", "....."});
  EXPECT_EQ(plus.metrics.max_distance_bins, std::sqrt(2.0));
  EXPECT_EQ(plus.metrics.distance_over_limit_count, 1);
}

// At the DEM's border no valid bin lies beyond: a 3 x 3 hole in the corner is 3 bins deep.
TEST(Coverage, HoleAtTheDemBorder) {
  const Coverage coverage = coverage_of({".....", "###..", "###..", "###.."});
  EXPECT_EQ(coverage.metrics.max_distance_bins, 3);
  EXPECT_EQ(coverage.squared_distance.at({0, 0}), 9);
  EXPECT_EQ(coverage.holes[0].depth_bins, 3);
}

// Only the region's bins make the hole; valid bins outside the region count for its distance, and invalid
// ones outside it do not join two holes.
TEST(Coverage, HoleAtTheRegionBorder) {
  const BinMask valid = all_but(drawn({"......", ".####.", ".#..#.", "......"}));
  const BinMask region = drawn({"......", ".#..#.", "####.#", "######"});
  const Coverage coverage = assess_coverage(valid, region, {});
  EXPECT_EQ(coverage.metrics.invalid_count, 3);
  ASSERT_EQ(coverage.holes.size(), 2U);
  EXPECT_EQ(coverage.holes[0].size_bins, 2);
  EXPECT_EQ(coverage.holes[1].first, (BinIndex{2, 4}));
  EXPECT_EQ(coverage.metrics.max_distance_bins, 1);
  EXPECT_EQ(coverage.invalid.at({2, 2}), 0);
  EXPECT_EQ(coverage.squared_distance.at({2, 2}), 1);  // the layer covers the DEM
  EXPECT_EQ(coverage.metrics.invalid_frac, 3.0 / 13);
}

TEST(Coverage, NoValidBinIsInfinitelyFar) {
  const Coverage coverage = coverage_of({"###", "###"});
  EXPECT_EQ(coverage.metrics.invalid_frac, 1);
  EXPECT_EQ(coverage.metrics.max_distance_bins, kInfinity);
  EXPECT_EQ(coverage.metrics.distance_over_limit_count, 6);
  EXPECT_EQ(coverage.holes[0].depth_bins, kInfinity);
}

TEST(Coverage, HistogramAndHolesOverTheLimit) {
  const BinMask empty = drawn({"#.#.##", "......", "####.#"});
  const Coverage coverage = assess_coverage(all_but(empty), BinMask(empty.spec(), 1), {.hole_size = 2});
  EXPECT_EQ(coverage.metrics.hole_count, 5);
  EXPECT_EQ(coverage.metrics.largest_hole_bins, 4);
  EXPECT_EQ(coverage.metrics.holes_over_limit, 1);  // a hole of 2 is not over
  EXPECT_EQ(coverage.metrics.hole_size_histogram.size_bins, (std::vector<std::int64_t>{1, 2, 4}));
  EXPECT_EQ(coverage.metrics.hole_size_histogram.count, (std::vector<std::int64_t>{3, 1, 1}));
}

// judge_coverage() against assess_coverage().
void expect_equal(const BinMask& valid, const BinMask& region, const EvaluationLimits& limits) {
  const Coverage dense = assess_coverage(valid, region, limits);
  Grid<std::int8_t> expected(valid.spec(), 1);
  flag_coverage(dense, limits, expected);
  Grid<std::int8_t> fail(valid.spec(), 1);
  const JudgedCoverage judged = judge_coverage(valid, region, limits, fail);
  EXPECT_EQ(judged.metrics, dense.metrics);
  EXPECT_EQ(judged.holes, dense.holes);
  EXPECT_TRUE(std::ranges::equal(fail.values(), expected.values()));
}

TEST(JudgeCoverage, EqualsTheDenseResult) {
  constexpr GridSpec spec{1, -30, -40, 61, 81};
  for (const double frac : {0.0, 0.001, 0.05, 0.11, 0.2, 0.5, 0.95, 1.0}) {
    const BinMask valid = all_but(testing_masks::random_mask(spec, frac, 3));
    expect_equal(valid, BinMask(spec, 1), {.hole_size = 2, .hole_depth = 0.5});
    expect_equal(valid, circular_region(spec, 25), {.hole_size = 1});
    expect_equal(valid, testing_masks::random_mask(spec, 0.3, 4), {});
  }
}

// A square of 2 half - 1 bins: the centre of the second is too far from a valid bin for the short search.
TEST(JudgeCoverage, SmallAndLargeHoles) {
  constexpr GridSpec spec{1, 0, 0, 90, 90};
  for (const std::int64_t half : {3, 14, 40}) {
    BinMask hole(spec);
    for (const auto [row, col] : bins_of(spec))
      hole.at({row, col}) = std::max(std::abs(row - 44), std::abs(col - 5)) < half ? 1 : 0;
    expect_equal(all_but(hole), BinMask(spec, 1), {.hole_depth = 4});
  }
}

}  // namespace
}  // namespace landfall
