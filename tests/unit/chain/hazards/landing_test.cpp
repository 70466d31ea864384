// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/landing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"

namespace landfall {
namespace {

constexpr Lander kFourLegs{.legs = 4, .leg_radius_m = 0.5, .pad_diameter_m = 0.1, .body_radius_m = 0.5};
constexpr HazardLimits kLimits{.slope_deg = 10, .roughness_m = 0.2};

Landing land(const Touchdown& touchdown, const GroundElevation& elevation) {
  return judge_landing(touchdown, kFourLegs, kLimits, 0.1, elevation);
}

TEST(Landing, OnAPlaneHasItsSlopeInEveryYaw) {
  const double gradient = std::tan(8 * std::numbers::pi / 180);
  for (const double yaw_deg : {0.0, 17.0, 45.0, 200.0, -30.0}) {
    const Landing landing = land({3.04, -2, yaw_deg}, [&](double x, double) { return gradient * x; });
    EXPECT_NEAR(landing.slope_deg, 8, 1.5) << yaw_deg;  // a pad takes the highest of its bins
    EXPECT_TRUE(landing.is_safe);
    EXPECT_EQ(landing.touchdown.x_m, 3.04);
  }
}

// A step under one leg of four: the lander rests on the diagonal with it.
TEST(Landing, StandsInItsOwnYaw) {
  const auto step = [](double x, double y) { return x > 0.35 && std::abs(y) < 0.12 ? 0.1 : 0.0; };
  const Landing on_step = land({0, 0, 0}, step);
  EXPECT_NEAR(on_step.slope_deg, std::atan(std::hypot(0.1, 0.1)) * 180 / std::numbers::pi, 1e-9);
  const Landing beside = land({0, 0, 45}, step);
  EXPECT_EQ(beside.slope_deg, 0);
  EXPECT_NEAR(beside.roughness_m, 0.1, 1e-12);
  EXPECT_TRUE(beside.is_safe);
}

TEST(Landing, StandsAtTheNearestPointOfTheLattice) {
  const auto cliff = [](double x, double) { return x > 0.501 ? 10.0 : 0.0; };
  EXPECT_TRUE(land({-0.151, 0, 0}, cliff).is_safe);
  EXPECT_FALSE(land({0.06, 0, 0}, cliff).is_safe);  // the pad of the first leg reaches 0.6 m
}

TEST(Landing, OverNoGroundIsNotSafe) {
  const auto half = [](double x, double) { return x < 1 ? 0.0 : std::nan(""); };
  EXPECT_TRUE(land({0.2, 0, 0}, half).is_safe);
  const Landing beyond = land({0.6, 0, 0}, half);
  EXPECT_FALSE(beyond.is_safe);
  EXPECT_TRUE(std::isnan(beyond.slope_deg) && std::isnan(beyond.roughness_m));
  EXPECT_FALSE(land({1e12, 0, 0}, half).is_safe);
}

TEST(Landing, NeedsLegsOfTwoBins) {
  const auto flat = [](double, double) { return 0.0; };
  EXPECT_THROW(static_cast<void>(judge_landing({}, kFourLegs, kLimits, 0.3, flat)), UsageError);
}

TEST(LandingErrors, DependOnTheSeedOnly) {
  const LandingErrors first = draw_landing(5, {});
  EXPECT_EQ(first.unit_x, draw_landing(5, 90).unit_x);
  EXPECT_EQ(draw_landing(5, 90).yaw_deg, 90);
  EXPECT_NE(first.unit_x, first.unit_y);
  EXPECT_NE(first.unit_x, draw_landing(6, {}).unit_x);
  EXPECT_TRUE(first.yaw_deg >= 0 && first.yaw_deg < 360);
  const Touchdown place =
      LandingErrors{.x_m = 1, .y_m = -2, .unit_x = 0.5, .unit_y = -1, .yaw_deg = 7}.touchdown(10, 20, 2);
  EXPECT_EQ(place.x_m, 12);
  EXPECT_EQ(place.y_m, 16);
  EXPECT_EQ(place.yaw_deg, 7);
}

}  // namespace
}  // namespace landfall
