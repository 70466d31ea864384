// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>

#include "base/core/error.h"
#include "chain/lidar/scanner/patterns.h"
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
