// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/patterns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>

#include "base/core/error.h"
#include "constants.h"
#include "pattern_random.h"

namespace landfall {
namespace {

/// Tips of petals within [0, span_s): times where the distance from the centre is greatest.
int petals(const Rosette& rosette, double span_s, int samples) {
  int count = 0;
  const auto distance = [&](int i) { return aim_at(rosette, span_s * (i + 0.3) / samples).norm(); };
  for (int i = 0; i < samples; ++i)
    if (distance(i) > distance(i - 1) && distance(i) >= distance(i + 1)) ++count;
  return count;
}

TEST(Rosette, KnownPoints) {
  const Rosette rosette({.radius_m = 10, .rates_hz = {1, -2}, .phases_rad = {0, 0}});
  EXPECT_LT((aim_at(rosette, 0) - Eigen::Vector3d(10, 0, 0)).norm(), 1e-14);
  // A quarter turn and half a turn back: 5 i - 5.
  EXPECT_LT((aim_at(rosette, 0.25) - Eigen::Vector3d(-5, 5, 0)).norm(), 1e-14);
  const Rosette turned({.radius_m = 10, .rates_hz = {1, -2}, .phases_rad = {kPi / 2, kPi}});
  EXPECT_LT((aim_at(turned, 0) - Eigen::Vector3d(-5, 5, 0)).norm(), 1e-14);
}

// |x + i y|^2 = R^2/2 (1 + cos(2 pi (f2 - f1) t + phi2 - phi1)).
TEST(Rosette, DistanceFromTheCentre) {
  PatternRandom random;
  for (int trial = 0; trial < 1000; ++trial) {
    const RosetteParameters p{.radius_m = random.real(0.1, 100),
                              .rates_hz = {random.real(-200, 200), random.real(-200, 200)},
                              .phases_rad = {random.real(-7, 7), random.real(-7, 7)}};
    const double t = random.real(0, 2);
    const double angle = 2 * kPi * (p.rates_hz[1] - p.rates_hz[0]) * t + p.phases_rad[1] - p.phases_rad[0];
    const Eigen::Vector3d aim = aim_at(Rosette(p), t);
    ASSERT_NEAR(aim.squaredNorm() / (p.radius_m * p.radius_m), (1 + std::cos(angle)) / 2, 1e-12);
    ASSERT_EQ(aim.z(), 0);
  }
}

// f2/f1 = p/q in lowest terms: |p - q| petals, and closed after q turns of the first phasor, not sooner.
TEST(Rosette, CountsItsPetals) {
  for (int q = 1; q <= 5; ++q)
    for (int p = -9; p <= 9; ++p) {
      if (p == q || std::gcd(p, q) != 1) continue;
      const double first_hz = 3;
      const Rosette rosette({.rates_hz = {first_hz, first_hz * p / q}});
      const double closed_s = q / first_hz;
      EXPECT_EQ(petals(rosette, closed_s, 5000), std::abs(p - q)) << p << "/" << q;
      for (double t = 0; t < 1; t += 0.01)
        ASSERT_LT((aim_at(rosette, t + closed_s) - aim_at(rosette, t)).norm(), 1e-11);
      for (int turns = 1; turns < q; ++turns) {
        double farthest = 0;
        for (double t = 0; t < 1; t += 0.01)
          farthest = std::max(farthest, (aim_at(rosette, t + turns / first_hz) - aim_at(rosette, t)).norm());
        EXPECT_GT(farthest, 1) << p << "/" << q << " closes after " << turns;
      }
    }
}

TEST(Rosette, EqualRatesAreACircleOppositeOnesALine) {
  const Rosette circle({.radius_m = 10, .rates_hz = {7, 7}});
  const Rosette line({.radius_m = 10, .rates_hz = {7, -7}});
  for (double t = 0; t < 1; t += 0.01) {
    EXPECT_NEAR(aim_at(circle, t).norm(), 10, 1e-13);
    EXPECT_NEAR(aim_at(line, t).y(), 0, 1e-13);
  }
}

TEST(Rosette, SaysHowItIsRun) {
  EXPECT_TRUE(Rosette({}).compensated());
  EXPECT_FALSE(Rosette({.compensated = false}).compensated());
  EXPECT_FALSE(Rosette({}).pulse_limit().has_value());
}

TEST(Rosette, RefusesParametersOutOfRange) {
  for (const double bad : {0.0, -1.0, HUGE_VAL, std::nan("")})
    EXPECT_THROW(Rosette({.radius_m = bad}), UsageError) << bad;
  for (const double bad : {HUGE_VAL, std::nan("")}) {
    EXPECT_THROW(Rosette({.rates_hz = {bad, 1}}), UsageError) << bad;
    EXPECT_THROW(Rosette({.rates_hz = {1, bad}}), UsageError) << bad;
    EXPECT_THROW(Rosette({.phases_rad = {bad, 0}}), UsageError) << bad;
    EXPECT_THROW(Rosette({.phases_rad = {0, bad}}), UsageError) << bad;
  }
}

}  // namespace
}  // namespace landfall
