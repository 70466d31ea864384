// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/patterns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"
#include "constants.h"
#include "pattern_random.h"

namespace landfall {
namespace {

TEST(Lissajous, KnownPoints) {
  const Lissajous figure({.half_width_m = {4, 3}, .rates_hz = {1, 2}});
  EXPECT_EQ(aim_at(figure, 0), Eigen::Vector3d(0, 0, 0));
  EXPECT_LT((aim_at(figure, 0.125) - Eigen::Vector3d(4 * std::numbers::sqrt2 / 2, 3, 0)).norm(), 1e-14);
  EXPECT_LT((aim_at(figure, 0.25) - Eigen::Vector3d(4, 0, 0)).norm(), 1e-14);
}

// A quarter turn of phase at equal rates: (x/A_x)^2 + (y/A_y)^2 = 1.
TEST(Lissajous, EqualRatesAQuarterApartAreAnEllipse) {
  const Lissajous ellipse({.half_width_m = {4, 3}, .rates_hz = {5, 5}, .phase_rad = kPi / 2});
  for (double t = 0; t < 1; t += 0.01) {
    const Eigen::Vector3d aim = aim_at(ellipse, t);
    EXPECT_NEAR(aim.x() * aim.x() / 16 + aim.y() * aim.y() / 9, 1, 1e-13);
  }
}

// x = sin u: y = sin 2u lies on y^2 = 4 x^2 (1 - x^2), y = sin 3u on y = 3x - 4x^3.
TEST(Lissajous, LiesOnItsAlgebraicCurve) {
  const Lissajous eight({.half_width_m = {1, 1}, .rates_hz = {1, 2}});
  const Lissajous cubic({.half_width_m = {1, 1}, .rates_hz = {1, 3}});
  for (double t = 0; t < 1; t += 0.003) {
    const Eigen::Vector3d a = aim_at(eight, t);
    EXPECT_NEAR(a.y() * a.y(), 4 * a.x() * a.x() * (1 - a.x() * a.x()), 1e-13);
    const Eigen::Vector3d b = aim_at(cubic, t);
    EXPECT_NEAR(b.y(), 3 * b.x() - 4 * b.x() * b.x() * b.x(), 1e-13);
  }
}

// f_x/f_y = p/q: closed after q/f_y. It touches the right edge p times and the upper one q times on its way.
TEST(Lissajous, ClosesAndTouchesItsEdges) {
  const Lissajous figure({.half_width_m = {2, 2}, .rates_hz = {15, 10}, .phase_rad = 0.3});
  const double closed_s = 2 / 10.0;
  for (double t = 0; t < 1; t += 0.01)
    EXPECT_LT((aim_at(figure, t + closed_s) - aim_at(figure, t)).norm(), 1e-12);
  int right = 0;
  int upper = 0;
  constexpr int kSamples = 3000;
  const auto at = [&](int i) { return aim_at(figure, closed_s * i / kSamples); };
  for (int i = 0; i < kSamples; ++i) {
    if (at(i).x() > at(i - 1).x() && at(i).x() >= at(i + 1).x()) ++right;
    if (at(i).y() > at(i - 1).y() && at(i).y() >= at(i + 1).y()) ++upper;
  }
  EXPECT_EQ(right, 3);
  EXPECT_EQ(upper, 2);
}

TEST(Lissajous, StaysInItsRectangle) {
  PatternRandom random;
  for (int trial = 0; trial < 1000; ++trial) {
    const LissajousParameters p{.half_width_m = {random.real(0.1, 100), random.real(0.1, 100)},
                                .rates_hz = {random.real(0, 200), random.real(0, 200)},
                                .phase_rad = random.real(-7, 7)};
    const Eigen::Vector3d aim = aim_at(Lissajous(p), random.real(0, 100));
    ASSERT_LE(std::abs(aim.x()), p.half_width_m[0]);
    ASSERT_LE(std::abs(aim.y()), p.half_width_m[1]);
    ASSERT_EQ(aim.z(), 0);
  }
}

TEST(Lissajous, SaysHowItIsRun) {
  EXPECT_TRUE(Lissajous({}).compensated());
  EXPECT_FALSE(Lissajous({.compensated = false}).compensated());
  EXPECT_FALSE(Lissajous({}).pulse_limit().has_value());
}

TEST(Lissajous, RefusesParametersOutOfRange) {
  for (const double bad : {-1.0, HUGE_VAL, std::nan("")}) {
    EXPECT_THROW(Lissajous({.half_width_m = {bad, 1}}), UsageError) << bad;
    EXPECT_THROW(Lissajous({.half_width_m = {1, bad}}), UsageError) << bad;
    EXPECT_THROW(Lissajous({.rates_hz = {bad, 1}}), UsageError) << bad;
    EXPECT_THROW(Lissajous({.rates_hz = {1, bad}}), UsageError) << bad;
  }
  EXPECT_THROW(Lissajous({.half_width_m = {0, 1}}), UsageError);
  EXPECT_THROW(Lissajous({.phase_rad = HUGE_VAL}), UsageError);
}

}  // namespace
}  // namespace landfall
