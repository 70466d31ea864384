// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"
#include "bins.h"
#include "chain/hazards/lander.h"
#include "chain/hazards/landing.h"
#include "chain/hazards/padded_map.h"

namespace landfall {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(LanderStencil, YawsMoveAPadByAtMostOneBin) {
  for (const int legs : {3, 4})
    for (const double radius_m : {0.1, 0.3, 0.85, 1.7, 4.0}) {
      const LanderStencil lander({.legs = legs, .leg_radius_m = radius_m}, 0.05);
      for (std::size_t m = 0; m < lander.yaws.size(); ++m)
        for (std::size_t leg = 0; leg < static_cast<std::size_t>(legs); ++leg) {
          const bool is_last = m + 1 == lander.yaws.size();
          const BinOffset& here = lander.yaws[m][leg];
          const BinOffset& there =
              lander.yaws[is_last ? 0 : m + 1][is_last ? (leg + 1) % static_cast<std::size_t>(legs) : leg];
          EXPECT_LE(std::abs(here.rows - there.rows), 1);
          EXPECT_LE(std::abs(here.cols - there.cols), 1);
        }
    }
}

TEST(LanderStencil, ThePapersFootprint) {
  const LanderStencil lander({}, 0.05);
  EXPECT_EQ(lander.yaws.size(), 27U);
  EXPECT_EQ(lander.yaws[0], (PadOffsets{{{0, 17}, {17, 0}, {0, -17}, {-17, 0}}}));
  EXPECT_EQ(lander.body.bin_count(), 901);
  EXPECT_EQ(lander.pad.half_bins(), 2);
}

// 2.5 bins less half of the tolerance of 1e-9 bins, and less twice that tolerance.
TEST(LanderStencil, APadNearTheBorderOfTwoBinsStandsOnTheFartherOne) {
  EXPECT_EQ(LanderStencil({.leg_radius_m = 0.25 - 0.5e-10}, 0.1).yaws[0][0], (BinOffset{0, 3}));
  EXPECT_EQ(LanderStencil({.leg_radius_m = 0.25 - 2e-10}, 0.1).yaws[0][0], (BinOffset{0, 2}));
}

// A quarter of a turn is 20 bins long, and half of the tolerance of 1e-9 more; and twice that tolerance more.
TEST(LanderStencil, TheNumberOfYawsHasATolerance) {
  const auto yaws = [](double quarter_bins) {
    return LanderStencil({.leg_radius_m = quarter_bins * 0.1 / (std::numbers::pi / 2)}, 0.1).yaws.size();
  };
  EXPECT_EQ(yaws(20 + 0.5e-9), 20U);
  EXPECT_EQ(yaws(20 + 2e-9), 21U);
}

TEST(LanderStencil, ThreeLegsStandAtEqualAngles) {
  const LanderStencil lander({.legs = 3, .leg_radius_m = 1}, 0.1);
  EXPECT_EQ(lander.yaws.size(), 21U);
  EXPECT_EQ(lander.yaws[0][0], (BinOffset{0, 10}));
  EXPECT_EQ(lander.yaws[0][1], (BinOffset{9, -5}));
  EXPECT_EQ(lander.yaws[0][2], (BinOffset{-9, -5}));
}

TEST(LanderStencil, RefusesWhatCannotStand) {
  const auto refusal = [](const Lander& lander) { return [=] { LanderStencil(lander, 0.05); }; };
  EXPECT_THAT(refusal({.legs = 5}), ThrowsMessage<UsageError>(HasSubstr("lander/legs: 5 is not 3 or 4")));
  EXPECT_THAT(refusal({.leg_radius_m = 0.09}),
              ThrowsMessage<UsageError>(HasSubstr("lander/leg_radius_m: 0.09 is less than 2 bins")));
  EXPECT_THAT(refusal({.leg_radius_m = NAN}), ThrowsMessage<UsageError>(HasSubstr("lander/leg_radius_m")));
  EXPECT_THAT(refusal({.pad_diameter_m = 0}),
              ThrowsMessage<UsageError>(HasSubstr("lander/pad_diameter_m: 0 is not finite and positive")));
  EXPECT_THAT(refusal({.body_radius_m = NAN}), ThrowsMessage<UsageError>(HasSubstr("lander/body_radius_m")));
  EXPECT_NO_THROW(refusal({.leg_radius_m = 0.1})());
}

constexpr Lander kFourLegs{.legs = 4, .leg_radius_m = 0.5, .pad_diameter_m = 0.1, .body_radius_m = 0.5};
constexpr HazardLimits kLimits{.slope_deg = 10, .roughness_m = 0.2};

Landing land(const Touchdown& touchdown, const TerrainElevation& elevation) {
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

// Narrower and wider than the room that a row has beyond its margins.
TEST(PaddedMap, IsTheMapWithUnknownBinsAround) {
  const GridSpec spec{1, 0, 0, 5, 7};
  Grid<double> z(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) z.values()[i] = static_cast<double>(i);
  for (const std::int64_t margin : {0, 3, 40}) {
    const PaddedMap padded(z, margin);
    EXPECT_EQ(padded.rows(), 5);
    EXPECT_EQ(padded.cols(), 7);
    EXPECT_EQ(padded.margin(), margin);
    for (const auto [row, col] : Bins({-margin, -margin}, {5 + margin, 7 + margin}))
      if (spec.contains({row, col}))
        EXPECT_EQ(*padded.at(row, col), z.at({row, col}));
      else
        EXPECT_TRUE(std::isnan(*padded.at(row, col))) << margin << ' ' << row << ' ' << col;
  }
}

}  // namespace
}  // namespace landfall
