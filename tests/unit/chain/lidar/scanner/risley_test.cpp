// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/risley.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "constants.h"
#include "risley_cases.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using enum RisleyConfiguration;

Beam risley_beam(const Risley& risley, const RisleyAngles& angles,
                 const Vector3d& pixel = Vector3d::UnitZ()) {
  const std::array<Direction<LidarFrame>, 1> pixels{{{pixel}}};
  // The earlier contents must not stay.
  std::array<Beam, 1> beams{Beam{.exit = {{1, 1, 1}}, .lost = true}};
  risley.steer({.angle_1_rad = angles.theta_1_rad, .angle_2_rad = angles.theta_2_rad}, pixels, beams);
  return beams[0];
}

/// The same ray by another way: long double, each refraction a turn of the ray by the difference of the two
/// angles of Snell's law, each crossing Eigen's intersection of a line and a plane.
struct OracleRay {
  using Vector = Eigen::Matrix<long double, 3, 1>;
  Vector p = Vector::Zero();
  Vector d;
  bool lost = false;

  void cross(const Vector& normal, long double vertex_m, long double before, long double behind) {
    const auto face = Eigen::Hyperplane<long double, 3>(normal, Vector(0, 0, vertex_m));
    p = Eigen::ParametrizedLine<long double, 3>(p, d).intersectionPoint(face);
    const Vector axis = d.cross(normal);
    const long double sine = before / behind * axis.norm();
    lost = lost || sine > 1 || d.dot(normal) <= 0;
    if (lost || axis.norm() == 0) return;
    const long double angle = std::atan2(axis.norm(), d.dot(normal)) - std::asin(sine);
    d = Eigen::AngleAxis<long double>(angle, axis.normalized()) * d;
  }
};

OracleRay oracle(const RisleyOptics& optics, const RisleyAngles& angles, const Vector3d& pixel) {
  OracleRay ray{.d = pixel.cast<long double>().normalized()};
  long double z = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const RisleyPrism& prism = optics.prisms[i / 2];
    const long double a = letters(optics.configuration)[i] == 'T' ? prism.wedge_rad : 0;
    const long double theta = i < 2 ? angles.theta_1_rad : angles.theta_2_rad;
    const OracleRay::Vector normal(std::sin(a) * std::cos(theta), std::sin(a) * std::sin(theta), std::cos(a));
    const long double n = prism.index;
    ray.cross(normal, z, i % 2 == 0 ? 1 : n, i % 2 == 0 ? n : 1);
    z += i % 2 == 0 ? prism.thickness_m : optics.gap_m;
  }
  return ray;
}

struct Golden {
  double theta_1_deg, theta_2_deg;
  Vector3d direction;
  Vector3d exit_mm;
};

// The default prisms, from the vector law in 40-digit arithmetic.
TEST(Risley, GoldenRays) {
  const Golden golden[] = {
      {0, 180, {-0.14918469504316268, 0, 0.98880934803675807}, {-0.9022524460713, 0, 16}},
      {0, 0, {0, 0, 1}, {-0.3048785194305, 0, 16}},
      {0,
       90,
       {-0.075148090637665925, 0.074588907754673409, 0.99437883088563283},
       {-0.6027887634296, 0.2991017063341, 16}},
      {30,
       150,
       {-0.12943615089379383, -0.00041809407626503542, 0.99158767037470894},
       {-0.7812200495083, -0.151563245422, 16}},
      {45,
       200,
       {-0.12275772923828449, -0.078477333923468085, 0.98932898874566721},
       {-0.7076870689359, -0.5285251710483, 16}},
      {10,
       -70,
       {-0.048462472629003476, -0.083230753875271746, 0.99535120955170242},
       {-0.4914437951304, -0.385623482548, 16}},
  };
  const Risley risley({});
  for (const Golden& g : golden) {
    const Beam beam = risley_beam(risley, {g.theta_1_deg * kDegree, g.theta_2_deg * kDegree});
    EXPECT_FALSE(beam.lost);
    EXPECT_LT((beam.direction.v - g.direction).cwiseAbs().maxCoeff(), 1e-15) << g.theta_2_deg;
    EXPECT_LT((beam.exit.v * 1000 - g.exit_mm).cwiseAbs().maxCoeff(), 1e-12) << g.theta_2_deg;
  }
}

TEST(Risley, TraceEqualsTheClosedForms) {
  RisleyDraws draws;
  for (const RisleyConfiguration configuration : kRisleyConfigurations) {
    double worst = 0;
    for (int i = 0; i < 10000; ++i) {
      const RisleyOptics optics = draws.optics(configuration);
      const RisleyAngles angles = draws.angles();
      const auto expected = RisleySteering(optics).direction(angles);
      const Beam beam = risley_beam(Risley({.optics = optics}), angles);
      ASSERT_EQ(beam.lost, !expected.has_value());
      if (!beam.lost) worst = std::max(worst, (beam.direction.v - expected->v).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst, 1e-14) << letters(configuration);
  }
}

TEST(Risley, OffAxisRaysEqualAnIndependentTrace) {
  RisleyDraws draws;
  for (const RisleyConfiguration configuration : kRisleyConfigurations) {
    double worst = 0;
    double worst_exit_m = 0;
    for (int i = 0; i < 2500; ++i) {
      const RisleyOptics optics = draws.optics(configuration);
      const RisleyAngles angles = draws.angles();
      const Vector3d pixel = Vector3d(draws.uniform(-0.2, 0.2), draws.uniform(-0.2, 0.2), 1).normalized();
      const OracleRay expected = oracle(optics, angles, pixel);
      const Beam beam = risley_beam(Risley({.optics = optics}), angles, pixel);
      ASSERT_EQ(beam.lost, expected.lost);
      if (beam.lost) continue;
      worst = std::max(worst, (beam.direction.v - expected.d.cast<double>()).norm());
      worst_exit_m = std::max(worst_exit_m, (beam.exit.v - expected.p.cast<double>()).norm());
    }
    EXPECT_LT(worst, 5e-15) << letters(configuration);
    EXPECT_LT(worst_exit_m, 1e-15) << letters(configuration);
  }
}

// A plate moves a ray without turning it: two wedges of 0.
TEST(Risley, PlatesShiftTheRay) {
  const RisleyPrism plate{.index = 1.5, .wedge_rad = 0, .thickness_m = 0.01};
  const Risley risley({.optics = {.prisms = {plate, plate}, .gap_m = 0.005}});
  const double off = 0.3;
  const Beam beam = risley_beam(risley, {1, 2}, {std::sin(off), 0, std::cos(off)});
  EXPECT_LT((beam.direction.v - Vector3d(std::sin(off), 0, std::cos(off))).norm(), 1e-15);
  const double inside = std::asin(std::sin(off) / 1.5);
  EXPECT_NEAR(beam.exit.v.x(), 0.02 * std::tan(inside) + 0.005 * std::tan(off), 1e-17);
  EXPECT_NEAR(beam.exit.v.z(), 0.025, 1e-17);
}

// n = 1.5, prism 1 tilted at its exit by 41.5 deg, critical angle 41.81 deg: a ray 0.01 rad off the axis is
// 0.38 deg off it inside the glass, beyond the critical angle on one side only.
TEST(Risley, TotalReflectionLosesTheRay) {
  const RisleyPrism steep{.wedge_rad = 41.5 * kDegree};
  const Risley risley({.optics = {.prisms = {steep, {.wedge_rad = 0}}}});
  EXPECT_FALSE(risley_beam(risley, {0, 0}).lost);
  EXPECT_FALSE(risley_beam(risley, {0, 0}, {std::sin(0.01), 0, std::cos(0.01)}).lost);
  EXPECT_TRUE(risley_beam(risley, {0, 0}, {-std::sin(0.01), 0, std::cos(0.01)}).lost);
  EXPECT_TRUE(risley_beam(risley, {kPi, 0}, {std::sin(0.01), 0, std::cos(0.01)}).lost);
}

// TPPT, 32 deg wedges: opposed, the boresight meets the very last face at 43.3 deg.
TEST(Risley, TotalReflectionOnTheLastFaceLosesTheRay) {
  const RisleyPrism steep{.wedge_rad = 32 * kDegree};
  const Risley risley({.optics = {.prisms = {steep, steep}, .configuration = tppt}});
  EXPECT_FALSE(risley_beam(risley, {1, 1}).lost);
  EXPECT_TRUE(risley_beam(risley, {1, 1 + kPi}).lost);
}

TEST(Risley, RotatesEvenly) {
  const Risley risley({.drive = RisleyRotation{.rates_hz = {100, -61.8}, .phases_rad = {0.3, -1}}});
  for (const double t : {0.0, 0.00005, 0.7, 1.99995, 1000.0}) {
    // The aim has no say.
    const ScannerState state = risley.state({.time = {7, t}, .aim = Direction<LidarFrame>{{1, 0, 0}}});
    EXPECT_NEAR(std::remainder(state.angle_1_rad - (200 * kPi * t + 0.3), 2 * kPi), 0, 1e-15 + 1e-10 * t);
    EXPECT_NEAR(std::remainder(state.angle_2_rad - (-123.6 * kPi * t - 1), 2 * kPi), 0, 1e-15 + 1e-10 * t);
    EXPECT_LE(std::abs(state.angle_1_rad), kPi);
    EXPECT_LE(std::abs(state.angle_2_rad), kPi);
    EXPECT_FALSE(state.blanked);
    EXPECT_TRUE(risley.is_known());
  }
}

// Opposite rates draw a line, the perpendicular part being of third order; equal ones a circle.
TEST(Risley, OppositeRatesDrawALineEqualOnesACircle) {
  const Risley line({.drive = RisleyRotation{.rates_hz = {50, -50}, .phases_rad = {0, kPi}}});
  const Risley circle({.drive = RisleyRotation{.rates_hz = {50, 50}, .phases_rad = {0, 2}}});
  const double radius = risley_beam(circle, {0, 2}).direction.v.head<2>().norm();
  for (int k = 0; k < 400; ++k) {
    const PulseContext pulse{.time = {k, k * 5e-5}};
    const ScannerState on_line = line.state(pulse);
    const Vector3d d = risley_beam(line, {on_line.angle_1_rad, on_line.angle_2_rad}).direction.v;
    EXPECT_LT(std::abs(d.y()), std::pow(8.5 * kDegree, 3)) << k;
    EXPECT_NEAR(d.x(), -0.1491847 * std::cos(100 * kPi * k * 5e-5), 1e-3) << k;
    const ScannerState on_circle = circle.state(pulse);
    const Vector3d c = risley_beam(circle, {on_circle.angle_1_rad, on_circle.angle_2_rad}).direction.v;
    EXPECT_NEAR(c.head<2>().norm(), radius, 1e-15);
  }
}

TEST(Risley, FollowsTheAimOnBothBranches) {
  RisleyDraws draws;
  for (const RisleyBranch branch : {RisleyBranch::positive, RisleyBranch::negative}) {
    const Risley risley({.drive = branch});
    for (int i = 0; i < 1000; ++i) {
      const double off = draws.uniform(0, 8.57 * kDegree);
      const double azimuth = draws.uniform(-kPi, kPi);
      const Vector3d aim(std::sin(off) * std::cos(azimuth), std::sin(off) * std::sin(azimuth), std::cos(off));
      const ScannerState state = risley.state({.aim = Direction<LidarFrame>{aim}});
      ASSERT_LT((risley_beam(risley, {state.angle_1_rad, state.angle_2_rad}).direction.v - aim).norm(),
                1e-14);
    }
  }
}

// How far the beam passes from the origin of L, from which the aim is taken; as in scanner-risley.md.
TEST(Risley, SpotOffsetOfTheDefaultPrisms) {
  for (const auto& [configuration, largest_mm] :
       {std::pair{pttp, 1.495}, {tppt, 1.539}, {ptpt, 1.835}, {tptp, 1.193}}) {
    RisleyOptics optics;
    optics.configuration = configuration;
    const Risley risley({.optics = optics});
    double largest = 0;
    for (int degrees = 0; degrees <= 180; ++degrees) {
      const Beam beam = risley_beam(risley, {0, degrees * kDegree});
      largest = std::max(largest, beam.exit.v.cross(beam.direction.v).norm());
    }
    EXPECT_NEAR(1e3 * largest, largest_mm, 1e-3) << letters(configuration);
  }
}

TEST(Risley, WithoutAnAimBothAnglesAreZero) {
  const ScannerState state = Risley({.drive = RisleyBranch::positive}).state({.time = {3, 1}});
  EXPECT_EQ(state.angle_1_rad, 0);
  EXPECT_EQ(state.angle_2_rad, 0);
}

TEST(Risley, RefusesAnAimOutsideTheReachByPulseAndAngle) {
  const auto aim_at = [](RisleyConfiguration configuration, double off_deg) {
    const double off = off_deg * kDegree;
    static_cast<void>(
        Risley({.optics = {.configuration = configuration}, .drive = RisleyBranch::positive})
            .state({.time = {42, 0}, .aim = Direction<LidarFrame>{{std::sin(off), 0, std::cos(off)}}}));
  };
  EXPECT_THAT([&] { aim_at(pttp, 9); }, ThrowsMessage<FormatError>(AllOf(HasSubstr("pulse 42 aims 9 degrees"),
                                                                         HasSubstr("reach 0 to 8.57968 "))));
  EXPECT_THAT([&] { aim_at(ptpt, 0.01); },
              ThrowsMessage<FormatError>(HasSubstr("pulse 42 aims 0.01 degrees off the boresight; the prisms "
                                                   "reach 0.040")));
  EXPECT_NO_THROW(aim_at(pttp, 8.5796));
}

TEST(Risley, SaysWhenNoAimCanBeReached) {
  const Risley risley(
      {.optics = {.prisms = {{{.wedge_rad = 42 * kDegree}, {}}}}, .drive = RisleyBranch::positive});
  EXPECT_THAT([&] { static_cast<void>(risley.state({.aim = Direction<LidarFrame>{}})); },
              ThrowsMessage<FormatError>(HasSubstr("reflect the boresight totally")));
}

// The mechanism is off the commanded angles, which are what the lander believes.
TEST(Risley, EncoderNoise) {
  const double sigma = 1e-4;
  const RisleyRotation rotation{};
  const Risley ideal({.drive = rotation});
  const Risley noisy({.drive = rotation, .encoder_sigma_rad = sigma, .seed = 5});
  EXPECT_FALSE(noisy.is_known());
  constexpr int kPulses = 20000;
  double sum[2] = {0, 0};
  double product = 0;
  double squares[2] = {0, 0};
  for (int k = 0; k < kPulses; ++k) {
    const PulseContext pulse{.time = {k, k * 5e-5}};
    const ScannerState truth = noisy.state(pulse);
    const ScannerState estimated = noisy.estimated_state(pulse, truth);
    ASSERT_EQ(estimated.angle_1_rad, ideal.state(pulse).angle_1_rad);
    ASSERT_EQ(estimated.angle_2_rad, ideal.state(pulse).angle_2_rad);
    const double off[2] = {(truth.angle_1_rad - estimated.angle_1_rad) / sigma,
                           (truth.angle_2_rad - estimated.angle_2_rad) / sigma};
    for (int i = 0; i < 2; ++i) {
      sum[i] += off[i];
      squares[i] += off[i] * off[i];
    }
    product += off[0] * off[1];
  }
  // Five sigma of each mean.
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(sum[i] / kPulses, 0, 5 / std::sqrt(kPulses));
    EXPECT_NEAR(squares[i] / kPulses, 1, 5 * std::sqrt(2.0 / kPulses));
  }
  EXPECT_NEAR(product / kPulses, 0, 5 / std::sqrt(kPulses));
}

TEST(Risley, RefusesParametersOutOfRange) {
  const auto refused = [](const RisleyParameters& parameters, const char* text) {
    EXPECT_THAT([&] { Risley{parameters}; }, ThrowsMessage<UsageError>(HasSubstr(text)));
  };
  refused({.optics = {.gap_m = -1}}, "gap_m: -1");
  refused({.drive = RisleyRotation{.rates_hz = {1, HUGE_VAL}}}, "rates_hz/1: inf is not in [-1e6, 1e6]");
  refused({.drive = RisleyRotation{.phases_rad = {std::nan(""), 0}}}, "phases_deg/0: nan is not finite");
  refused({.encoder_sigma_rad = -1e-6}, "encoder_sigma_rad: -1e-06 is not finite and >= 0");
}

}  // namespace
}  // namespace landfall
