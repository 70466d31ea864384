// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/patterns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "constants.h"
#include "pattern_random.h"

namespace landfall {
namespace {

/// The area that the aim has swept about the origin up to time t: pi r^2.
double swept_m2(const Spiral& spiral, double t_s) { return kPi * aim_at(spiral, t_s).squaredNorm(); }

TEST(Spiral, KnownPoints) {
  const Spiral spiral({.radius_m = 8, .pitch_m = 2, .period_s = 4});
  EXPECT_EQ(aim_at(spiral, 0), Eigen::Vector3d::Zero());
  // r = 8 sqrt(1/4) = 4: two whole turns; r = 8: four.
  EXPECT_LT((aim_at(spiral, 1) - Eigen::Vector3d(4, 0, 0)).norm(), 1e-14);
  EXPECT_LT((aim_at(spiral, 4) - Eigen::Vector3d(8, 0, 0)).norm(), 1e-14);
  // r = 8 sqrt(25/256) = 2.5: a turn and a quarter, so up the map.
  EXPECT_LT((aim_at(spiral, 4 * 25.0 / 256) - Eigen::Vector3d(0, 2.5, 0)).norm(), 1e-14);
}

TEST(Spiral, EveryPulseSweepsTheSameArea) {
  const SpiralParameters p{.radius_m = 50, .pitch_m = 0.5, .inner_radius_m = 3};
  const Spiral spiral(p);
  const double expected = kPi * (50 * 50 - 3 * 3) / 40000;
  for (int k = 0; k < 40000; ++k)
    ASSERT_NEAR((swept_m2(spiral, (k + 1) / 20000.0) - swept_m2(spiral, k / 20000.0)) / (kPi * 2500),
                expected / (kPi * 2500), 1e-12)
        << "pulse " << k;
}

// The azimuth, unwrapped over a dense sampling, is 2 pi r/pitch: 100 turns.
TEST(Spiral, TurnsLieOnePitchApart) {
  const Spiral spiral({.radius_m = 50, .pitch_m = 0.5, .inner_radius_m = 0.25});
  double azimuth = kPi;
  Eigen::Vector3d before = aim_at(spiral, 0);
  for (int k = 1; k <= 200000; ++k) {
    const Eigen::Vector3d now = aim_at(spiral, 2 * k / 200000.0);
    azimuth += std::atan2(before.cross(now).z(), before.dot(now));
    ASSERT_NEAR(now.norm(), 0.5 * azimuth / (2 * kPi), 1e-9);
    before = now;
  }
  EXPECT_NEAR(azimuth, 100 * 2 * kPi, 1e-8);
}

// pi (R^2 - r0^2)/(N p) = 0.3927 m along the turn, far from the centre.
TEST(Spiral, PulsesAreEvenlySpaced) {
  const Spiral spiral({});
  for (int k = 20000; k < 39999; ++k)
    ASSERT_NEAR((aim_at(spiral, (k + 1) / 20000.0) - aim_at(spiral, k / 20000.0)).norm(), kPi / 8, 1e-4);
}

TEST(Spiral, InwardBeginsAtTheRim) {
  const SpiralParameters out{.radius_m = 20, .inner_radius_m = 2, .period_s = 3};
  SpiralParameters in = out;
  in.direction = SpiralDirection::inward;
  EXPECT_DOUBLE_EQ(aim_at(Spiral(in), 0).norm(), 20);
  EXPECT_DOUBLE_EQ(aim_at(Spiral(in), 3).norm(), 2);
  for (double t = 0; t <= 3; t += 0.125)
    EXPECT_LT((aim_at(Spiral(in), t) - aim_at(Spiral(out), 3 - t)).norm(), 1e-12);
}

TEST(Spiral, RunsBackAfterAPeriod) {
  const Spiral spiral({.radius_m = 20, .period_s = 4});
  for (double t = 0; t <= 4; t += 0.125) {
    EXPECT_LT((aim_at(spiral, 8 - t) - aim_at(spiral, t)).norm(), 1e-12);
    EXPECT_LT((aim_at(spiral, 8 + t) - aim_at(spiral, t)).norm(), 1e-12);
  }
}

TEST(Spiral, StaysWithinItsRadiiAndAimsAtTheGround) {
  PatternRandom random;
  for (int trial = 0; trial < 200; ++trial) {
    const double radius = random.real(0.1, 1000);
    const double inner = radius * random.real(0, 0.99);
    const Spiral spiral(
        {.radius_m = radius,
         .pitch_m = random.real(0.01, 10),
         .inner_radius_m = inner,
         .period_s = random.real(0.01, 10),
         .direction = random.whole(0, 1) == 0 ? SpiralDirection::outward : SpiralDirection::inward});
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d aim = aim_at(spiral, random.real(0, 100));
      ASSERT_LE(aim.norm(), radius * (1 + 1e-15));
      ASSERT_GE(aim.norm(), inner * (1 - 1e-12));
      ASSERT_EQ(aim.z(), 0);
    }
  }
}

TEST(Spiral, SaysHowItIsRun) {
  EXPECT_TRUE(Spiral({}).compensated());
  EXPECT_FALSE(Spiral({.compensated = false}).compensated());
  EXPECT_FALSE(Spiral({}).pulse_limit().has_value());
}

TEST(Spiral, RefusesParametersOutOfRange) {
  for (const double bad : {0.0, -1.0, HUGE_VAL, std::nan("")}) {
    EXPECT_THROW(Spiral({.radius_m = bad}), UsageError) << bad;
    EXPECT_THROW(Spiral({.pitch_m = bad}), UsageError) << bad;
    EXPECT_THROW(Spiral({.period_s = bad}), UsageError) << bad;
  }
  EXPECT_THROW(Spiral({.inner_radius_m = -0.1}), UsageError);
  EXPECT_THROW(Spiral({.radius_m = 5, .inner_radius_m = 5}), UsageError);
  EXPECT_THROW(Spiral({.inner_radius_m = std::nan("")}), UsageError);
}

}  // namespace
}  // namespace landfall
