// SPDX-License-Identifier: GPL-3.0-or-later
// decide() against evaluate(), to the last bit.
#include "chain/evaluation/judge/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "base/raster/masks.h"
#include "bins.h"
#include "collected_layers.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing_layers::collected;
using testing_layers::Collected;
using testing_layers::perfect_dem;

const BinMask* mask_of(const DemLayers& dem) { return dem.region_mask ? &*dem.region_mask : nullptr; }

BinMask region_of(const DemLayers& dem, const EvaluationParameters& parameters) {
  return judged_region(parameters, dem.z_est.spec(), mask_of(dem));
}

void expect_equal(const Verdict& verdict, const Collected& full) {
  EXPECT_EQ(verdict.metrics.coverage, full.metrics.coverage);
  EXPECT_EQ(verdict.metrics.requirements, full.metrics.requirements);
  EXPECT_EQ(verdict.metrics.pass, full.metrics.pass);
  EXPECT_TRUE(std::ranges::equal(verdict.fail.values(), full.layers.fail.values()));
  ASSERT_EQ(verdict.metrics.accuracy.has_value(), full.metrics.accuracy.has_value());
  if (!full.metrics.accuracy) return;
  const DecisiveMetrics::Accuracy& accuracy = *verdict.metrics.accuracy;
  const AccuracyMetrics& expected = *full.metrics.accuracy;
  EXPECT_EQ(accuracy.absolute.horizontal.within_limit_frac, expected.absolute.horizontal.within_limit_frac);
  EXPECT_EQ(accuracy.relative.x.violation_count, expected.relative.x.violation_count);
  EXPECT_EQ(accuracy.relative.y.violation_count, expected.relative.y.violation_count);
  EXPECT_EQ(accuracy.relative.z.violation_count, expected.relative.z.violation_count);
}

/// Returns the evaluation.
Collected expect_exact(const DemLayers& dem, const EvaluationParameters& parameters) {
  Collected full = collected(dem, parameters);
  const BinMask region = region_of(dem, parameters);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    SCOPED_TRACE(std::to_string(threads) + " threads");
    expect_equal(decide(dem, region, parameters), full);
  }
  return full;
}

EvaluationParameters small_region() {
  EvaluationParameters parameters;
  parameters.region_radius_m = 4;
  parameters.footprint_m = 5;
  return parameters;
}

enum class Relief { noise, drift, cones, rocks };

struct SceneRecipe {
  Relief relief = Relief::noise;
  double sigma_m = 0.02;
  double empty_frac = 0;       ///< bins without an elevation, with truth or without
  double no_truth_frac = 0;    ///< bins whose true elevation is unknown
  std::int64_t hole_bins = 0;  ///< edge of a square without any value
  std::uint64_t seed = 1;
};

/// The error of the elevation before noise.
double relief_error_m(Relief relief, BinIndex bin, double u) {
  const auto row = static_cast<double>(bin.row);
  const auto col = static_cast<double>(bin.col);
  if (relief == Relief::drift) return 0.002 * row - 0.001 * col + 0.01 * std::sin(0.2 * col);
  if (relief == Relief::noise) return 0;
  const double edge = relief == Relief::cones ? 40 : 11;
  const double radius = relief == Relief::cones ? 12 : 4;
  const bool inside = std::hypot(std::fmod(row, edge) - edge / 2, std::fmod(col, edge) - edge / 2) < radius;
  return inside ? 0.2 * (u - 0.5) : 0;
}

DemLayers scene(const GridSpec& spec, const SceneRecipe& recipe) {
  const RandomField normal(recipe.seed, RandomStream::range_noise);
  const RandomField uniform(recipe.seed, RandomStream::dropout);
  DemLayers dem = perfect_dem(spec);
  for (const auto [row, col] : bins_of(spec)) {
    const std::size_t i = spec.index({row, col});
    TrueLayers& truth = *dem.truth;
    truth.z.values()[i] +=
        relief_error_m(recipe.relief, {row, col}, uniform.uniform(i, 1)) + recipe.sigma_m * normal.normal(i);
    truth.x.values()[i] += 0.05 * (uniform.uniform(i, 2) - 0.5) + recipe.sigma_m * normal.normal(i, 2);
    truth.y.values()[i] += 0.05 * (uniform.uniform(i, 3) - 0.5) + 0.003 * static_cast<double>(row);
    const bool in_hole = std::max(std::abs(row - 20), std::abs(col - 23)) < recipe.hole_bins / 2;
    if (in_hole || uniform.uniform(i, 4) < recipe.empty_frac) {
      dem.z_est.values()[i] = kNan;
      if (in_hole || uniform.uniform(i, 5) < 0.7) truth.x.values()[i] = truth.y.values()[i] = kNan;
    }
    if (in_hole || uniform.uniform(i, 6) < recipe.no_truth_frac) truth.z.values()[i] = kNan;
  }
  return dem;
}

/// A value of an axis's layer of relative errors, so that the limit is one of them.
double some_value(const Grid<double>& e, const EvaluationParameters& parameters, std::uint64_t seed) {
  const Footprint footprint = footprint_of(parameters, e.spec().resolution_m);
  const Grid<double> relative =
      footprint_statistics(e, BinMask(e.spec(), 1), {footprint, parameters.quantile}).relative;
  const RandomField pick(seed, RandomStream::fractal);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto at = static_cast<std::size_t>(pick.uniform(i) * static_cast<double>(e.spec().size()));
    if (!std::isnan(relative.values()[at])) return relative.values()[at];
  }
  return 0.05;
}

EvaluationParameters random_parameters(std::uint64_t i, const DemLayers& dem) {
  const RandomField draw(77, RandomStream::fractal);
  const double quantiles[] = {0, 0.5, 0.95, 1, 0.9, draw.uniform(i, 1)};
  EvaluationParameters p;
  p.region_shape = std::array{RegionShape::circle, RegionShape::square, RegionShape::mask}[i % 3];
  const double margin = static_cast<double>(std::min(dem.z_est.spec().rows, dem.z_est.spec().cols)) / 2 - 1;
  p.region_radius_m = 1 + (margin - 1) * draw.uniform(i, 2);
  p.region_half_width_m = std::floor(p.region_radius_m);
  p.footprint_m = 1 + 22 * draw.uniform(i, 3) * draw.uniform(i, 4);
  p.footprint_shape = i % 2 == 0 ? FootprintShape::square : FootprintShape::disc;
  p.quantile = quantiles[i / 2 % 6];
  p.limits.relative_z_m = 0.08 * draw.uniform(i, 5);
  p.limits.relative_xy_m = 0.06 * draw.uniform(i, 6);
  p.limits.horizontal_m = 0.2 * draw.uniform(i, 7);
  p.limits.hole_size = static_cast<std::int64_t>(5 * draw.uniform(i, 8));
  if (i % 5 == 0) p.limits.relative_z_m = some_value(error_of(Axis::z, dem.truth->z, dem.z_est), p, i);
  if (i % 7 == 0) p.limits.relative_xy_m = some_value(error_of(Axis::x, dem.truth->x, dem.z_est), p, i);
  return p;
}

TEST(Decide, FiftyRandomScenes) {
  const RandomField draw(5, RandomStream::fractal);
  std::int64_t violations = 0;
  for (std::uint64_t i = 0; i < 50; ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    const auto half_rows = 4 + static_cast<std::int64_t>(56 * draw.uniform(i, 0));
    const auto half_cols = 4 + static_cast<std::int64_t>(56 * draw.uniform(i, 1));
    const GridSpec spec{1, -half_rows, -half_cols, 2 * half_rows + 1, 2 * half_cols + 2};
    SceneRecipe recipe{.relief = static_cast<Relief>(i % 4), .sigma_m = 0.03 * draw.uniform(i, 2), .seed = i};
    if (i % 2 == 1) recipe.empty_frac = std::pow(draw.uniform(i, 3), 4);
    if (i % 3 == 1) recipe.no_truth_frac = draw.uniform(i, 4);
    if (i % 4 == 1) recipe.hole_bins = static_cast<std::int64_t>(40 * draw.uniform(i, 5));
    DemLayers dem = scene(spec, recipe);
    dem.region_mask = testing_masks::random_mask(spec, 0.05 + 0.95 * draw.uniform(i, 6), i);
    const Collected full = expect_exact(dem, random_parameters(i, dem));
    violations += full.metrics.accuracy->relative.z.violation_count.value_or(0);
  }
  EXPECT_GT(violations, 1000);
}

TEST(Decide, TheFootprintOfThePaper) {
  const GridSpec spec = GridSpec::centered(80, 1);
  EvaluationParameters parameters = small_region();
  parameters.region_radius_m = 80;
  parameters.footprint_m = 35;
  for (const Relief relief : {Relief::noise, Relief::drift, Relief::cones, Relief::rocks}) {
    DemLayers dem = scene(spec, {.relief = relief, .sigma_m = 0.012, .empty_frac = 0.01});
    for (const double limit : {0.024, 0.05, 0.07}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(relief)) + ", limit " + std::to_string(limit));
      parameters.limits.relative_z_m = limit;
      expect_exact(dem, parameters);
    }
  }
}

// All windows have the value 0.1 or nearly so: each is decided by the quantile or the count alone.
TEST(Decide, LimitsThatValuesHit) {
  DemLayers dem = perfect_dem(20);
  for (std::size_t i = 0; i < dem.z_est.values().size(); ++i)
    dem.truth->z.values()[i] += i % 2 == 0 ? 0.1 : -0.1;
  EvaluationParameters parameters = small_region();
  parameters.region_radius_m = 15;
  for (const double footprint : {5.0, 7.0, 9.0}) {
    for (const double quantile : {0.0, 0.25, 0.5, 0.75, 0.95, 1.0}) {
      parameters.footprint_m = footprint;
      parameters.quantile = quantile;
      const double exact = collected(dem, parameters).metrics.accuracy->relative.z.max_m.value();
      for (const double limit : {std::nextafter(exact, 0), exact, std::nextafter(exact, 1), 0.0, 0.1}) {
        SCOPED_TRACE(std::to_string(footprint) + " m, quantile " + std::to_string(quantile) + ", limit " +
                     std::to_string(limit));
        parameters.limits.relative_z_m = limit;
        expect_exact(dem, parameters);
      }
    }
  }
}

// One of 25 values exceeds the limit, and the quantile lies between it and the next.
TEST(Decide, OneWrongElevation) {
  DemLayers dem = perfect_dem(5);
  dem.truth->z.at({5, 5}) += 2.5;
  EvaluationParameters parameters = small_region();
  parameters.quantile = 0.99;
  parameters.limits.relative_z_m = 0.2;
  EXPECT_EQ(expect_exact(dem, parameters).metrics.requirements["relative_elevation"].value, 25);
}

TEST(Decide, TooFewBinsAreNotJudged) {
  const DemLayers dem = scene(GridSpec::centered(20, 1), {.sigma_m = 1, .empty_frac = 0.1});
  EvaluationParameters parameters = small_region();
  parameters.region_radius_m = 15;
  for (const double footprint_m : {1.0, 3.0, 3.99}) {
    for (const FootprintShape shape : {FootprintShape::square, FootprintShape::disc}) {
      parameters.footprint_m = footprint_m;
      parameters.footprint_shape = shape;
      const Collected full = expect_exact(dem, parameters);
      EXPECT_EQ(full.metrics.requirements["relative_elevation"].reason, kFootprintBins);
      EXPECT_TRUE(std::ranges::none_of(full.layers.fail.values(), [](std::int8_t flags) {
        return (flags & (fail_relative_x | fail_relative_y | fail_relative_z)) != 0;
      }));
    }
  }
}

TEST(Decide, AbsoluteErrorsAtTheLimit) {
  DemLayers dem = perfect_dem(20);
  for (double& x : dem.truth->x.values()) x += 3;
  for (double& y : dem.truth->y.values()) y -= 4;
  EvaluationParameters parameters = small_region();
  for (const double limit : {std::nextafter(5.0, 0.0), 5.0, 4.999, 5.001, 0.0, 1e300}) {
    parameters.limits.horizontal_m = limit;
    expect_exact(dem, parameters);
  }
  dem.truth->x.at({20, 20}) += 0.01;
  parameters.limits.horizontal_m = 5;
  expect_exact(dem, parameters);
}

TEST(Decide, WithoutTruth) {
  DemLayers dem = scene(GridSpec::centered(20, 1), {.empty_frac = 0.3});
  dem.truth.reset();
  const Collected full = expect_exact(dem, small_region());
  EXPECT_FALSE(full.metrics.pass.has_value());
}

TEST(Decide, WithoutAnyValue) {
  DemLayers dem = perfect_dem(10);
  std::ranges::fill(dem.z_est.values(), kNan);
  expect_exact(dem, small_region());
  std::ranges::fill(dem.truth->x.values(), kNan);
  const Collected full = expect_exact(dem, small_region());
  EXPECT_FALSE(full.metrics.requirements["relative_horizontal"].value.has_value());
}

TEST(Decide, AFootprintLargerThanTheDem) {
  DemLayers dem = scene(GridSpec::centered(12, 1), {.sigma_m = 0.03, .empty_frac = 0.1});
  EvaluationParameters parameters = small_region();
  for (const double footprint : {24.0, 49.0, 51.0, 1e5}) {
    parameters.footprint_m = footprint;
    for (const FootprintShape shape : {FootprintShape::square, FootprintShape::disc}) {
      if (footprint == 1e5 && shape == FootprintShape::disc) continue;
      parameters.footprint_shape = shape;
      expect_exact(dem, parameters);
    }
  }
}

TEST(Decide, ErrorsThatOverflow) {
  DemLayers dem = scene(GridSpec::centered(20, 1), {});
  dem.truth->z.at({20, 20}) = 1.7e308;
  dem.truth->z.at({20, 21}) = 1.7e308;
  dem.truth->x.at({18, 21}) = -1.7e308;
  expect_exact(dem, small_region());
}

TEST(Decide, RefusesWhatEvaluateRefuses) {
  const BinMask region(GridSpec::centered(5, 1), 1);
  const auto refusal = [&](const DemLayers& dem, const EvaluationParameters& parameters) -> std::string {
    return landfall::refusal<Error>([&] { return decide(dem, region, parameters); });
  };
  EvaluationParameters parameters = small_region();
  parameters.quantile = 1.5;
  EXPECT_THAT(refusal(perfect_dem(5), parameters), testing::HasSubstr("quantile"));
  DemLayers dem = perfect_dem(5);
  dem.truth->z = Grid<double>(GridSpec::centered(6, 1));
  EXPECT_EQ(refusal(dem, small_region()), "z_true: its grid differs from that of z_est");
  for (const double infinite : {HUGE_VAL, -HUGE_VAL}) {
    dem = perfect_dem(5);
    dem.truth->z.at({3, 4}) = infinite;
    dem.z_est.at({3, 4}) = kNan;
    EXPECT_EQ(refusal(dem, small_region()), "z_true: the value in row 3, column 4 is infinite");
    dem.z_est.at({2, 1}) = infinite;
    EXPECT_EQ(refusal(dem, small_region()), "z_est: the value in row 2, column 1 is infinite");
    dem.truth.reset();
    EXPECT_EQ(refusal(dem, small_region()), "z_est: the value in row 2, column 1 is infinite");
    dem = perfect_dem(5);
    dem.truth->y.at({10, 10}) = infinite;
    EXPECT_EQ(refusal(dem, small_region()), "y_true: the value in row 10, column 10 is infinite");
  }
}

}  // namespace
}  // namespace landfall
