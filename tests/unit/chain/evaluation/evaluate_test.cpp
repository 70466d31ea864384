// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "bins.h"
#include "collected_layers.h"
#include "constants.h"
#include "judged.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing_layers::Collected;
using testing_layers::collected;
using testing_layers::Layers;
using testing_layers::perfect_dem;

/// A DEM with noise of some centimetres and 5 % empty bins.
DemLayers noisy(std::int64_t half) {
  DemLayers dem = perfect_dem(half);
  const RandomField noise(3, RandomStream::range_noise);
  const RandomField empty(3, RandomStream::dropout);
  for (std::size_t i = 0; i < dem.z_est.spec().size(); ++i) {
    const bool none = empty.uniform(i) < 0.05;
    Grid<double>* const layers[] = {&dem.z_est, &dem.truth->x, &dem.truth->y, &dem.truth->z};
    for (std::size_t k = 0; k < 4; ++k) {
      double& value = layers[k]->values()[i];
      value = none ? kNan : value + 0.03 * noise.normal(i, k);
    }
  }
  return dem;
}

EvaluationParameters small() {
  EvaluationParameters parameters;
  parameters.region_radius_m = 4;
  parameters.footprint_m = 5;
  parameters.quantile = 0.99;
  return parameters;
}

template <class T>
bool same_bits(const Grid<T>& a, const Grid<T>& b) {
  return a.spec() == b.spec() && std::ranges::equal(a.values(), b.values(), [](T x, T y) {
           if constexpr (std::is_same_v<T, double>)
             return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
           else if constexpr (std::is_same_v<T, float>)
             return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
           else
             return x == y;
         });
}

bool same_bits(const AxisLayers& a, const AxisLayers& b) {
  return same_bits(a.error, b.error) && same_bits(a.absolute, b.absolute) &&
         same_bits(a.relative, b.relative);
}

TEST(Evaluate, PerfectDemPasses) {
  const Collected evaluation = collected(perfect_dem(5), small());
  EXPECT_EQ(evaluation.metrics.pass, true);
  EXPECT_EQ(evaluation.metrics.region, (RegionMetrics{RegionShape::circle, 4.0, {}, 45, 0.0, 0.0}));
  ASSERT_TRUE(evaluation.metrics.accuracy);
  EXPECT_EQ(evaluation.metrics.accuracy->footprint_bins, 5);
  EXPECT_EQ(evaluation.metrics.accuracy->quantile, 0.99);
  EXPECT_EQ(evaluation.metrics.accuracy->absolute.z, (AbsoluteMetrics{0.0, 0.0, 0.0}));
  EXPECT_EQ(evaluation.metrics.accuracy->absolute.horizontal, (HorizontalMetrics{0.0, 1.0}));
  EXPECT_TRUE(std::ranges::all_of(evaluation.layers.fail.values(), [](std::int8_t f) { return f == 0; }));
}

// Eqs. 10-12 by hand: one bin of e_z = 2.5 in footprints of 25: mean 0.1, deviations 24 of 0.1 and one
// of 2.4; h = 23.76, so rel = 0.1 + 0.76 * 2.3 = 1.848, in the 25 footprints around it.
TEST(Evaluate, OneWrongElevation) {
  DemLayers dem = perfect_dem(5);
  dem.truth->z.at({5, 5}) += 2.5;
  const Collected evaluation = collected(dem, small());
  EXPECT_EQ(evaluation.metrics.requirements["relative_elevation"], (Judged{25.0, 0, false}));
  EXPECT_EQ(evaluation.metrics.requirements["relative_horizontal"].pass, true);
  EXPECT_EQ(evaluation.metrics.pass, false);
  const AccuracyMetrics& accuracy = *evaluation.metrics.accuracy;
  EXPECT_NEAR(accuracy.absolute.z.mean_m.value(), 0.1 * 25 / 45, 1e-14);
  EXPECT_NEAR(accuracy.absolute.z.max_m.value(), 0.1, 1e-14);
  EXPECT_NEAR(accuracy.relative.z.max_m.value(), 1.848, 1e-14);
  const Layers& layers = evaluation.layers;
  EXPECT_EQ(layers.fail.at({4, 6}), fail_relative_z);
  EXPECT_EQ(layers.fail.at({4, 8}), 0);
  EXPECT_EQ(layers.z->error.at({5, 5}), 2.5);
  EXPECT_NEAR(layers.z->absolute.at({6, 6}), 0.1, 1e-7);
  EXPECT_NEAR(layers.z->relative.at({6, 6}), 1.848, 1e-6);
}

TEST(Evaluate, AxesHaveTheirOwnFlags) {
  DemLayers dem = perfect_dem(5);
  dem.truth->x.at({5, 5}) -= 2.5;
  dem.truth->y.at({5, 7}) += 2.5;
  const Collected evaluation = collected(dem, small());
  EXPECT_EQ(evaluation.layers.fail.at({5, 3}), fail_relative_x);
  EXPECT_EQ(evaluation.layers.fail.at({5, 6}), fail_relative_x | fail_relative_y);
  EXPECT_EQ(evaluation.layers.fail.at({5, 8}), fail_relative_y);
  EXPECT_NEAR(evaluation.metrics.accuracy->absolute.x.mean_m.value(), -0.1 * 25 / 45, 1e-14);
  // 25 footprints along x; along y 20, because column 9 lies outside the region: 4^2 = 16.
  EXPECT_EQ(evaluation.metrics.requirements["relative_horizontal"].value, 45);
}

TEST(Evaluate, AbsoluteHorizontalIsTheHypotenuse) {
  DemLayers dem = perfect_dem(5);
  for (double& x : dem.truth->x.values()) x += 3;
  for (double& y : dem.truth->y.values()) y -= 4;
  EvaluationParameters parameters = small();
  parameters.limits.horizontal_m = 5;
  Collected evaluation = collected(dem, parameters);
  EXPECT_EQ(evaluation.metrics.accuracy->absolute.horizontal, (HorizontalMetrics{5.0, 1.0}));
  EXPECT_EQ(evaluation.metrics.accuracy->absolute.y, (AbsoluteMetrics{4.0, -4.0, 4.0}));
  EXPECT_EQ(evaluation.metrics.pass, true);
  parameters.limits.horizontal_m = std::nextafter(5, 0);
  evaluation = collected(dem, parameters);
  EXPECT_EQ(evaluation.metrics.requirements["absolute_horizontal"], (Judged{0.0, 0.95, false}));
  EXPECT_EQ(evaluation.layers.fail.at({5, 5}), fail_absolute_horizontal);
  EXPECT_EQ(evaluation.layers.fail.at({0, 0}), 0);  // outside the region
}

// As floats, 0.05 is above 0.05 and a little more than 0.05 is equal to it.
TEST(Evaluate, ViolationsAreJudgedInDouble) {
  DemLayers dem = perfect_dem(5);
  dem.truth->z.at({5, 5}) += 0.0865;
  EvaluationParameters parameters = small();
  const double largest = evaluate(dem, parameters).metrics.accuracy->relative.z.max_m.value();
  parameters.limits.relative_z_m = largest;
  const Collected at_limit = collected(dem, parameters);
  EXPECT_EQ(at_limit.metrics.requirements["relative_elevation"].value, 0);
  EXPECT_EQ(std::ranges::count(at_limit.layers.fail.values(), 0), 11 * 11);
  parameters.limits.relative_z_m = std::nextafter(largest, 0);
  ASSERT_EQ(static_cast<float>(largest), static_cast<float>(parameters.limits.relative_z_m));
  EXPECT_GT(evaluate(dem, parameters).metrics.requirements["relative_elevation"].value, 0);
}

TEST(Evaluate, HolesAndDistancesAreFlagged) {
  DemLayers dem = perfect_dem(5);
  for (const BinIndex bin : Bins({3, 3}, {8, 8})) dem.z_est.at(bin) = kNan;
  EvaluationParameters parameters = small();
  parameters.limits.hole_size = 24;
  const Collected evaluation = collected(dem, parameters);
  const Layers& layers = evaluation.layers;
  EXPECT_EQ(layers.fail.at({3, 3}), fail_hole_size);
  EXPECT_EQ(layers.fail.at({5, 5}), fail_hole_size | fail_hole_distance);
  EXPECT_EQ(layers.coverage.hole_numbers.at({5, 5}), 1);
  EXPECT_EQ(layers.coverage.distance_to_valid.at({5, 5}), 3);
  EXPECT_EQ(layers.coverage.distance_to_valid.at({2, 5}), 0);
  ASSERT_EQ(evaluation.holes.size(), 1U);
  EXPECT_EQ(evaluation.holes[0].centroid_x_m, 0);
  EXPECT_EQ(evaluation.metrics.coverage.invalid_frac, 25.0 / 45);
  // The footprint of (5, 5) has no valid e_z: no value, and no violation.
  EXPECT_TRUE(std::isnan(layers.z->absolute.at({5, 5})));
  EXPECT_EQ(evaluation.metrics.accuracy->relative.z.violation_count, 0);
  EXPECT_EQ(evaluation.metrics.requirements["hole_size"], (Judged{25.0, 24, false}));
  EXPECT_EQ(evaluation.metrics.requirements["hole_distance"], (Judged{3.0, 1, false}));
  parameters.limits.hole_size = 25;
  EXPECT_EQ(collected(dem, parameters).layers.fail.at({3, 3}), 0);
}

TEST(Evaluate, LayersOutsideTheRegion) {
  DemLayers dem = perfect_dem(5);
  dem.z_est.at({0, 0}) = kNan;
  const Layers layers = collected(dem, small()).layers;
  EXPECT_EQ(layers.coverage.in_region.at({0, 0}), 0);
  EXPECT_EQ(layers.coverage.in_region.at({5, 5}), 1);
  EXPECT_EQ(layers.coverage.invalid.at({0, 0}), 0);
  EXPECT_EQ(layers.coverage.hole_numbers.at({0, 0}), 0);
  EXPECT_EQ(layers.coverage.distance_to_valid.at({0, 0}), 1);
  EXPECT_TRUE(std::isnan(layers.x->absolute.at({0, 1})));
  EXPECT_TRUE(std::isnan(layers.x->relative.at({0, 1})));
  EXPECT_EQ(layers.x->error.at({0, 1}), 0);
}

// The region touches the DEM's border (R/s = 6 bins, 5 on each side of the origin): footprints there are
// clipped to three fifths. e_z = 0.6 on one bin of 15.
TEST(Evaluate, FootprintClippedAtTheDemBorder) {
  DemLayers dem = perfect_dem(5);
  dem.truth->z.at({0, 5}) += 0.6;
  EvaluationParameters parameters = small();
  parameters.region_radius_m = 6;
  const Collected evaluation = collected(dem, parameters);
  EXPECT_NEAR(evaluation.layers.z->absolute.at({0, 5}), 0.04, 1e-7);
  EXPECT_NEAR(evaluation.layers.z->absolute.at({2, 5}), 0.6 / 25, 1e-7);
}

TEST(Evaluate, StatisticsAreOfTheRegionsBins) {
  DemLayers dem = perfect_dem(5);
  for (double& z : dem.truth->z.values()) z += 0.25;
  for (double& x : dem.truth->x.values()) x += 3;
  for (double& y : dem.truth->y.values()) y += 4;
  dem.truth->z.at({0, 0}) += 100;  // outside
  dem.z_est.at({5, 5}) = kNan;
  const StatisticsMetrics statistics = evaluate(dem, small()).metrics.statistics;
  EXPECT_EQ(statistics.valid_frac, 1 - 1.0 / 45);
  EXPECT_EQ(statistics.z.count, 44);
  EXPECT_EQ(statistics.z.mean_m, 0.25);
  EXPECT_EQ(statistics.z.nmad_m, 0);
  EXPECT_EQ(statistics.x.count, 45);
  EXPECT_EQ(statistics.horizontal, (HorizontalStatistics{45, 5.0, 5.0}));
  EXPECT_FALSE(statistics.z_corrected);
}

TEST(Evaluate, CorrectedElevationIsMeasuredAndNotJudged) {
  DemLayers dem = perfect_dem(5);
  dem.corrected = dem.z_est;
  dem.corrected->at({5, 5}) -= 2.5;
  const Evaluation evaluation = evaluate(dem, small());
  const Evaluation without = evaluate(perfect_dem(5), small());
  EXPECT_EQ(evaluation.metrics.requirements, without.metrics.requirements);
  EXPECT_EQ(evaluation.metrics.statistics.z, without.metrics.statistics.z);
  EXPECT_NEAR(evaluation.metrics.statistics.z_corrected->mean_m.value(), 2.5 / 45, 1e-15);
  EXPECT_NEAR(evaluation.metrics.accuracy->absolute.z_corrected->max_m.value(), 0.1, 1e-14);
  EXPECT_NEAR(evaluation.metrics.accuracy->relative.z_corrected->max_m.value(), 1.848, 1e-14);
  EXPECT_EQ(evaluation.metrics.accuracy->relative.z_corrected->violation_count, 25);
  dem.corrected->at({1, 1}) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(static_cast<void>(evaluate(dem, small())), FormatError);
}

TEST(Evaluate, EachSinkGetsTheLayers) {
  Layers first;
  Layers second;
  static_cast<void>(evaluate(noisy(10), small(), {&first, &second}));
  ASSERT_TRUE(first.x && first.y && first.z && second.x && second.y && second.z);
  EXPECT_TRUE(same_bits(*first.x, *second.x));
  EXPECT_TRUE(same_bits(*first.y, *second.y));
  EXPECT_TRUE(same_bits(*first.z, *second.z));
  EXPECT_TRUE(same_bits(first.fail, second.fail));
  EXPECT_TRUE(same_bits(first.coverage.in_region, second.coverage.in_region));
  EXPECT_EQ(count_set(first.coverage.in_region), 45);
}

TEST(Evaluate, TellsWhichBinsItJudged) {
  Layers layers;
  EXPECT_TRUE(same_bits(evaluate(perfect_dem(5), small(), {&layers}).region, layers.coverage.in_region));
  EXPECT_TRUE(same_bits(evaluate(perfect_dem(5), small()).region, layers.coverage.in_region));
}

/// Without a sink the coverage is computed by itself, and no layer is made.
TEST(Evaluate, GivesTheSameWithoutASink) {
  DemLayers dem = perfect_dem(5);
  for (const BinIndex bin : {BinIndex{5, 5}, BinIndex{5, 6}, BinIndex{7, 3}})
    dem.z_est.at(bin) = std::numeric_limits<double>::quiet_NaN();
  dem.z_est.at({6, 4}) += 1;
  Layers layers;
  const Evaluation with = evaluate(dem, small(), {&layers});
  const Evaluation without = evaluate(dem, small());
  EXPECT_EQ(without.metrics, with.metrics);
  EXPECT_EQ(without.holes, with.holes);
  EXPECT_EQ(without.holes.size(), 2U);
  EXPECT_TRUE(same_bits(without.fail, layers.fail));
  EXPECT_TRUE(same_bits(with.fail, layers.fail));
  EXPECT_GT(count_set(without.fail), 0);
}

TEST(Evaluate, WithoutTruthOnlyCoverageIsJudged) {
  DemLayers dem = perfect_dem(5);
  dem.truth.reset();
  const Collected evaluation = collected(dem, small());
  EXPECT_EQ(evaluation.metrics.pass, std::nullopt);
  EXPECT_EQ(evaluation.metrics.accuracy, std::nullopt);
  EXPECT_EQ(evaluation.metrics.requirements["coverage"].pass, true);
  EXPECT_EQ(evaluation.metrics.requirements["relative_elevation"].pass, std::nullopt);
  EXPECT_FALSE(evaluation.layers.z);
}

TEST(Evaluate, WithTrueElevationsOnlyNothingHorizontalIsJudged) {
  DemLayers dem = noisy(12);
  dem.truth->x = dem.truth->y = {};
  EvaluationParameters parameters = small();
  parameters.limits.relative_z_m = 1;
  parameters.limits.invalid_share = 1;
  const Collected evaluation = collected(dem, parameters);
  EXPECT_EQ(evaluation.metrics.requirements["relative_elevation"].pass, true);
  for (const RequirementVerdict& horizontal : {evaluation.metrics.requirements["relative_horizontal"],
                                               evaluation.metrics.requirements["absolute_horizontal"]}) {
    EXPECT_EQ(horizontal.value, std::nullopt);
    EXPECT_EQ(horizontal.pass, std::nullopt);
  }
  EXPECT_EQ(evaluation.metrics.pass, std::nullopt);
  EXPECT_EQ(evaluation.metrics.statistics.x.count, std::nullopt);
  EXPECT_TRUE(evaluation.metrics.statistics.z.mean_m.has_value());
  EXPECT_TRUE(evaluation.layers.z);
  EXPECT_FALSE(evaluation.layers.x);
  parameters.limits.relative_z_m = 0;
  EXPECT_EQ(collected(dem, parameters).metrics.pass, false);
}

TEST(Evaluate, RelativeErrorsOfFewBinsAreNotJudged) {
  DemLayers dem = noisy(20);
  dem.corrected = dem.z_est;
  EvaluationParameters parameters = small();
  parameters.limits.invalid_share = 1;
  parameters.limits.hole_size = 1000;
  parameters.limits.hole_depth = 100;
  for (const auto& [footprint_m, bins] : {std::pair(1.0, 1), std::pair(3.99, 3)}) {
    SCOPED_TRACE(bins);
    parameters.footprint_m = footprint_m;
    const Collected evaluation = collected(dem, parameters);
    const Metrics& metrics = evaluation.metrics;
    EXPECT_EQ(metrics.assumptions->footprint_bins, bins);
    for (const RequirementVerdict& relative :
         {metrics.requirements["relative_elevation"], metrics.requirements["relative_horizontal"]})
      EXPECT_EQ(relative, (Judged{std::nullopt, 0, std::nullopt, kFootprintBins}));
    EXPECT_EQ(metrics.requirements["absolute_horizontal"].pass, true);
    EXPECT_EQ(metrics.pass, std::nullopt);
    EXPECT_EQ(metrics.accuracy->relative.z, RelativeMetrics{});
    EXPECT_EQ(metrics.accuracy->relative.z_corrected, RelativeMetrics{});
    EXPECT_TRUE(metrics.accuracy->absolute.z.p95_m.has_value());
    EXPECT_TRUE(std::isnan(evaluation.layers.z->relative.at({20, 20})));
    EXPECT_EQ(count_set(evaluation.layers.fail), 0);
  }
  parameters.limits.horizontal_m = 0;
  EXPECT_EQ(evaluate(dem, parameters).metrics.pass, false);
  parameters.footprint_m = 4;
  for (const FootprintShape shape : {FootprintShape::square, FootprintShape::disc}) {
    parameters.footprint_shape = shape;
    const RequirementVerdict judged = evaluate(dem, parameters).metrics.requirements["relative_elevation"];
    EXPECT_EQ(judged.pass, false);
    EXPECT_EQ(judged.reason, std::nullopt);
  }
}

TEST(Evaluate, TooFewBinsAndNoTruePositions) {
  DemLayers dem = perfect_dem(20);
  dem.truth->x = dem.truth->y = {};
  EvaluationParameters parameters = small();
  parameters.footprint_m = 1;
  const Metrics metrics = evaluate(dem, parameters).metrics;
  EXPECT_EQ(metrics.requirements["relative_horizontal"].reason, kFootprintBins);
  EXPECT_EQ(metrics.requirements["absolute_horizontal"].reason, std::nullopt);
  EXPECT_EQ(metrics.pass, std::nullopt);
}

TEST(Evaluate, AssumptionsAreOfTheRegionsBinsWithReturns) {
  DemLayers dem = perfect_dem(5);
  dem.truth_spacing_m = 0.5;
  EXPECT_EQ(evaluate(dem, small()).metrics.assumptions, (AssumptionMetrics{5, 0.5}));
  dem.count.emplace(dem.z_est.spec(), 9);
  for (const BinIndex bin : Bins({2, 2}, {9, 9})) dem.count->at(bin) = 0;
  EXPECT_EQ(evaluate(dem, small()).metrics.assumptions, (AssumptionMetrics{5, 0.5}));
  dem.count->at({5, 5}) = 1;
  dem.count->at({5, 6}) = 1000;
  EXPECT_EQ(evaluate(dem, small()).metrics.assumptions, (AssumptionMetrics{5, 0.5, 500.5, 0.5}));
  dem.count->at({6, 5}) = 700;
  EXPECT_EQ(evaluate(dem, small()).metrics.assumptions, (AssumptionMetrics{5, 0.5, 700.0, 1.0 / 3}));
  dem.truth.reset();
  EXPECT_EQ(evaluate(dem, small()).metrics.assumptions->truth_spacing_m, std::nullopt);
  dem.count.emplace(GridSpec::centered(4, 1));
  EXPECT_THROW(static_cast<void>(evaluate(dem, small())), FormatError);
}

TEST(Evaluate, DemWithoutAValidBinFails) {
  DemLayers dem = perfect_dem(5);
  for (Grid<double>* layer : {&dem.z_est, &dem.truth->x, &dem.truth->y, &dem.truth->z})
    std::ranges::fill(layer->values(), kNan);
  const Collected evaluation = collected(dem, small());
  EXPECT_EQ(evaluation.metrics.pass, false);
  EXPECT_EQ(evaluation.metrics.coverage.max_distance_bins, std::numeric_limits<double>::infinity());
  EXPECT_EQ(evaluation.metrics.accuracy->absolute.z, AbsoluteMetrics{});
  EXPECT_EQ(evaluation.metrics.requirements["relative_horizontal"].value, std::nullopt);
  EXPECT_EQ(evaluation.layers.coverage.distance_to_valid.at({5, 5}), std::numeric_limits<float>::infinity());
}

TEST(Evaluate, QuantileChangesRelativeOnly) {
  const DemLayers dem = noisy(20);
  EvaluationParameters parameters = small();
  parameters.region_radius_m = 15;
  const Metrics at_99 = evaluate(dem, parameters).metrics;
  parameters.quantile = 0.5;
  const Metrics at_50 = evaluate(dem, parameters).metrics;
  EXPECT_EQ(at_50.accuracy->absolute, at_99.accuracy->absolute);
  EXPECT_LT(at_50.accuracy->relative.z.max_m, at_99.accuracy->relative.z.max_m);
}

TEST(Evaluate, SameAtAnyThreadCountAndWithoutLayers) {
  const DemLayers dem = noisy(60);
  EvaluationParameters parameters = small();
  parameters.region_radius_m = 50;
  parameters.footprint_m = 9;
  const auto with_threads = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return collected(dem, parameters);
  };
  const Collected one = with_threads(1);
  const Collected two = with_threads(2);
  const Evaluation without_layers = evaluate(dem, parameters);
  EXPECT_EQ(one.metrics.accuracy->footprint_bins, 9);
  EXPECT_EQ(one.metrics, two.metrics);
  EXPECT_EQ(one.metrics, without_layers.metrics);
  EXPECT_EQ(one.holes, two.holes);
  EXPECT_EQ(one.holes, without_layers.holes);
  EXPECT_TRUE(same_bits(one.layers.fail, two.layers.fail));
  EXPECT_TRUE(same_bits(one.layers.coverage.hole_numbers, two.layers.coverage.hole_numbers));
  EXPECT_TRUE(same_bits(one.layers.coverage.distance_to_valid, two.layers.coverage.distance_to_valid));
  EXPECT_TRUE(same_bits(*one.layers.x, *two.layers.x));
  EXPECT_TRUE(same_bits(*one.layers.y, *two.layers.y));
  EXPECT_TRUE(same_bits(*one.layers.z, *two.layers.z));
}

TEST(Evaluate, ProgressRisesToOne) {
  std::vector<double> fractions;
  // 41 rows: each axis is told of more than once.
  static_cast<void>(evaluate(perfect_dem(20), small(), {}, [&](double f) { fractions.push_back(f); }));
  EXPECT_GE(fractions.size(), 7U);
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_GE(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
}

// One axis after another, each as long; the last hundredth is the summary's.
TEST(Evaluate, ProgressIsSharedOutEvenly) {
  const auto ends = [](DemLayers dem) {
    std::vector<double> fractions;
    static_cast<void>(evaluate(std::move(dem), small(), {}, [&](double f) { fractions.push_back(f); }));
    return fractions;
  };
  // A map of one row of tiles: each axis is told once, when it is done.
  EXPECT_THAT(ends(perfect_dem(5)), testing::ElementsAre(testing::DoubleEq(0.33), testing::DoubleEq(0.66),
                                                         testing::DoubleEq(0.99), 1.0));
  DemLayers corrected = perfect_dem(5);
  corrected.corrected = corrected.z_est;
  EXPECT_THAT(ends(corrected), testing::ElementsAre(testing::DoubleEq(0.2475), testing::DoubleEq(0.495),
                                                    testing::DoubleEq(0.7425), testing::DoubleEq(0.99), 1.0));
}

TEST(Evaluate, RefusesWhatDoesNotFit) {
  EvaluationParameters parameters = small();
  parameters.region_radius_m = 6.5;
  EXPECT_THROW(static_cast<void>(evaluate(perfect_dem(5), parameters)), UsageError);
  parameters = small();
  parameters.quantile = 2;
  EXPECT_THROW(static_cast<void>(evaluate(perfect_dem(5), parameters)), UsageError);
}

std::string evaluate_refusal(const DemLayers& dem, const EvaluationParameters& parameters = small()) {
  return refusal<FormatError>([&] { return evaluate(dem, parameters); });
}

TEST(Evaluate, RegionsOfOtherShapes) {
  DemLayers dem = perfect_dem(5);
  dem.z_est.at({0, 0}) = kNan;
  EvaluationParameters parameters = small();
  parameters.region_shape = RegionShape::square;
  parameters.region_half_width_m = 5;
  const Metrics square = evaluate(dem, parameters).metrics;
  EXPECT_EQ(square.region, (RegionMetrics{RegionShape::square, {}, 5.0, 121}));
  EXPECT_EQ(square.coverage.invalid_count, 1);
  parameters.region_shape = RegionShape::mask;
  EXPECT_EQ(evaluate_refusal(dem, parameters), "region/path: its grid differs from that of z_est");
  dem.region_mask = BinMask(GridSpec::centered(4, 1), 1);
  EXPECT_EQ(evaluate_refusal(dem, parameters), "region/path: its grid differs from that of z_est");
  dem.region_mask = BinMask(dem.z_est.spec());
  EXPECT_EQ(evaluate_refusal(dem, parameters), "region/path: no bin of the mask is set");
  dem.region_mask->at({0, 0}) = dem.region_mask->at({10, 3}) = 1;
  const Metrics mask = evaluate(dem, parameters).metrics;
  EXPECT_EQ(mask.region, (RegionMetrics{RegionShape::mask, {}, {}, 2}));
  EXPECT_EQ(mask.coverage.invalid_frac, 0.5);
  parameters.limits.hole_size = 0;
  EXPECT_EQ(collected(dem, parameters).layers.fail.at({0, 0}), fail_hole_size);
}

TEST(Evaluate, DiscsLeaveTheirCornersOut) {
  DemLayers dem = perfect_dem(5);
  dem.truth->z.at({5, 5}) += 0.9;
  EvaluationParameters parameters = small();
  parameters.footprint_m = 4;  // the bin, its eight neighbours and four bins two away
  parameters.footprint_shape = FootprintShape::disc;
  const Collected evaluation = collected(dem, parameters);
  EXPECT_NEAR(evaluation.layers.z->absolute.at({5, 7}), 0.9 / 13, 1e-7);
  EXPECT_EQ(evaluation.layers.z->absolute.at({6, 7}), 0);
  EXPECT_EQ(evaluation.metrics.requirements["relative_elevation"].value, 13);
}

TEST(Evaluate, RefusesInfiniteValues) {
  DemLayers dem = perfect_dem(5);
  dem.truth->y.at({2, 3}) = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "y_true: the value in row 2, column 3 is infinite");
  dem.truth.reset();
  dem.z_est.at({0, 1}) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "z_est: the value in row 0, column 1 is infinite");
  dem = perfect_dem(5);
  dem.truth->x.at({10, 10}) = dem.truth->x.at({10, 9}) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "x_true: the value in row 10, column 9 is infinite");
  dem = perfect_dem(5);
  dem.corrected = dem.z_est;
  dem.corrected->at({0, 0}) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "z_corrected: the value in row 0, column 0 is infinite");
}

// Layers are looked through in pieces of 2^18 values; the first infinite value of all is named.
TEST(Evaluate, RefusesInfiniteValuesInAnyPiece) {
  DemLayers dem{Grid<double>(GridSpec::centered(260, 1), 7), std::nullopt};  // 521 x 521 bins
  dem.z_est.at({520, 520}) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "z_est: the value in row 520, column 520 is infinite");
  dem.z_est.at({504, 3}) = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "z_est: the value in row 504, column 3 is infinite");
  dem.z_est.at({100, 7}) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(evaluate_refusal(dem), "z_est: the value in row 100, column 7 is infinite");
}

TEST(Evaluate, RefusesLayersOfDifferentGrids) {
  DemLayers dem = perfect_dem(5);
  dem.truth->z = Grid<double>(GridSpec::centered(4, 1));
  EXPECT_EQ(evaluate_refusal(dem), "z_true: its grid differs from that of z_est");
  dem = perfect_dem(5);
  dem.truth->y = Grid<double>(GridSpec::centered(4, 1));
  EXPECT_EQ(evaluate_refusal(dem), "y_true: its grid differs from that of z_est");
}

}  // namespace
}  // namespace landfall
