// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "base/core/error.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

std::string parameters_refusal(const std::function<void(EvaluationParameters&)>& change) {
  EvaluationParameters parameters;
  change(parameters);
  return refusal([&] { check(parameters); });
}

TEST(EvaluationParameters, DefaultsAreTable1) {
  const EvaluationParameters parameters;
  EXPECT_NO_THROW(check(parameters));
  EXPECT_EQ(parameters.region_radius_m, 50);
  EXPECT_EQ(parameters.region_half_width_m, 50);
  EXPECT_EQ(parameters.limits.invalid_share, 0.01);
  EXPECT_EQ(parameters.limits.hole_size, 10);
  EXPECT_EQ(parameters, EvaluationParameters{});
}

TEST(EvaluationParameters, LengthsAreFiniteAndPositive) {
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    EXPECT_THAT(parameters_refusal([&](auto& p) { p.region_radius_m = bad; }),
                testing::StartsWith("region_radius_m: "));
    EXPECT_THAT(parameters_refusal([&](auto& p) { p.region_half_width_m = bad; }),
                testing::StartsWith("region/half_width_m: "));
    EXPECT_THAT(parameters_refusal([&](auto& p) { p.footprint_m = bad; }),
                testing::StartsWith("footprint_m: "));
  }
}

TEST(EvaluationParameters, FractionsLieBetween0And1) {
  for (const double good : {0.0, 1.0})
    EXPECT_EQ(parameters_refusal([&](auto& p) {
                p.quantile = good;
                p.limits.invalid_share = good;
                p.limits.horizontal_share = good;
              }),
              "accepted");
  EXPECT_EQ(parameters_refusal([](auto& p) { p.quantile = 1.5; }), "quantile: 1.5 is not in [0, 1]");
  EXPECT_EQ(parameters_refusal([](auto& p) { p.quantile = kNan; }), "quantile: nan is not in [0, 1]");
  EXPECT_EQ(parameters_refusal([](auto& p) { p.limits.invalid_share = -0.5; }),
            "limits/invalid_frac: -0.5 is not in [0, 1]");
  EXPECT_EQ(parameters_refusal([](auto& p) { p.limits.horizontal_share = 2; }),
            "limits/absolute_horizontal_frac: 2 is not in [0, 1]");
}

TEST(EvaluationParameters, LimitsAreNotNegative) {
  EXPECT_EQ(parameters_refusal([](auto& p) { p.limits = {0, 0, 0, 0, 0, 0, 0}; }), "accepted");
  EXPECT_EQ(parameters_refusal([](auto& p) { p.limits.hole_size = -1; }),
            "limits/hole_bins: -1 is not finite and >= 0");
  for (const double bad : {-1.0, kNan, kInfinity}) {
    EXPECT_NE(parameters_refusal([&](auto& p) { p.limits.hole_depth = bad; }), "accepted");
    EXPECT_NE(parameters_refusal([&](auto& p) { p.limits.relative_z_m = bad; }), "accepted");
    EXPECT_NE(parameters_refusal([&](auto& p) { p.limits.relative_xy_m = bad; }), "accepted");
    EXPECT_NE(parameters_refusal([&](auto& p) { p.limits.horizontal_m = bad; }), "accepted");
  }
}

EvaluationParameters with_footprint(double footprint_m, FootprintShape shape = FootprintShape::square) {
  EvaluationParameters parameters;
  parameters.footprint_m = footprint_m;
  parameters.footprint_shape = shape;
  return parameters;
}

std::int64_t half_bins(double footprint_m, double resolution_m) {
  return footprint_of(with_footprint(footprint_m), resolution_m).half_bins();
}

TEST(FootprintOf, CentresWithinHalfTheEdgeInclusive) {
  EXPECT_EQ(half_bins(1.7, 0.05), 17);  // 35 bins; 1.7 / 0.1 = 16.999999999999996
  EXPECT_EQ(half_bins(1.7, 0.1), 8);    // 8.5 bins each way
  EXPECT_EQ(half_bins(1.69, 0.05), 16);
  EXPECT_EQ(half_bins(0.6, 0.1), 3);  // 0.6 / 0.2 = 2.9999999999999996
  EXPECT_EQ(half_bins(0.01, 1), 0);   // one bin
  EXPECT_TRUE(footprint_of(with_footprint(1.7), 0.05).is_square());
}

TEST(FootprintOf, DiscOfThatDiameterInclusive) {
  const Footprint disc = footprint_of(with_footprint(0.5, FootprintShape::disc), 0.05);
  EXPECT_FALSE(disc.is_square());
  EXPECT_EQ(disc.half_bins(), 5);
  EXPECT_EQ(disc.half_width(3), 4);  // on the circle
  // Radius 2.5 bins: 2^2 + 2^2 is outside, 2^2 + 1 inside.
  const Footprint between = footprint_of(with_footprint(5, FootprintShape::disc), 1);
  EXPECT_EQ(between.half_bins(), 2);
  EXPECT_EQ(between.half_width(2), 1);
}

TEST(FootprintOf, RefusesAFootprintBeyondCounting) {
  EXPECT_EQ(half_bins(0x1p21, 1), 0x1p20);
  const double beyond = 2 * (0x1p20 + 1 - 1e-9);
  ASSERT_EQ(beyond / 2 + 1e-9, 0x1p20 + 1);  // exactly the first that is too large
  EXPECT_THROW(static_cast<void>(half_bins(beyond, 1)), UsageError);
  EXPECT_EQ(half_bins(beyond - 1e-6, 1), 0x1p20);
  EXPECT_THROW(static_cast<void>(half_bins(0x1p22, 1)), UsageError);
  EXPECT_THROW(static_cast<void>(half_bins(1e300, 1e-300)), UsageError);
}

// 1.7 m: 1.7 / (2 s) is 2.5 at 0.34 m, 2.125 at 0.4 m, 2 at 0.425 m and 1.98 at 0.43 m.
TEST(WhyNotJudged, FootprintsOfFewerThanFiveBins) {
  const EvaluationParameters parameters;
  for (const double judged : {0.05, 0.34, 0.4, 0.425, 0.425 * (1 + 1e-10)})
    EXPECT_EQ(why_not_judged(parameters, judged), std::nullopt) << judged;
  EXPECT_EQ(
      why_not_judged(parameters, 0.43),
      "a footprint of 1.7 m has 3 x 3 bins of 0.43 m, and relative errors are judged from 5 x 5 bins on; "
      "the coarsest posting that can be judged is 0.425 m");
  for (const double coarse : {0.42501, 0.85, 1.0, 50.0})
    EXPECT_TRUE(why_not_judged(parameters, coarse).has_value()) << coarse;
  EXPECT_EQ(coarsest_judged_posting_m(with_footprint(4)), 1);
  EXPECT_EQ(why_not_judged(with_footprint(4, FootprintShape::disc), 1), std::nullopt);
}

TEST(EffectiveLimits, AreInfiniteForRelativeErrorsThatAreNotJudged) {
  EvaluationParameters parameters = with_footprint(4);
  EXPECT_EQ(effective_limits(parameters, Footprint::square(2)), parameters.limits);
  parameters.limits.relative_z_m = parameters.limits.relative_xy_m = kInfinity;
  EXPECT_EQ(effective_limits(with_footprint(4), Footprint::square(1)), parameters.limits);
}

TEST(LimitOfLayer, IsTheOneThatTheLayerIsJudgedBy) {
  const EvaluationLimits limits{.relative_z_m = 1, .relative_xy_m = 2, .horizontal_m = 3};
  for (const char* const layer : {"rel_z", "e_z"}) EXPECT_EQ(limit_of_layer(limits, layer), 1) << layer;
  for (const char* const layer : {"rel_x", "rel_y", "e_x", "e_y"})
    EXPECT_EQ(limit_of_layer(limits, layer), 2) << layer;
  for (const char* const layer : {"abs_x", "abs_y"}) EXPECT_EQ(limit_of_layer(limits, layer), 3) << layer;
  for (const char* const layer : {"abs_z", "z_est", "count", ""})
    EXPECT_EQ(limit_of_layer(limits, layer), std::nullopt) << layer;
}

}  // namespace
}  // namespace landfall
