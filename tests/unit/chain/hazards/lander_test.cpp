// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/lander.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"

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

}  // namespace
}  // namespace landfall
