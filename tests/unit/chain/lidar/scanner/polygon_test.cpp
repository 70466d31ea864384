// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/polygon.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

ScannerState polygon_state(const PolygonScanner& polygon, double t_s) {
  return polygon.state({.time = {0, t_s}});
}

// Four facets, one revolution per second: a facet is used for 1/4 s, +-45 deg of turn, of which half.
TEST(Polygon, FacetAfterFacet) {
  const PolygonScanner polygon({.facets = 4, .rate_hz = 1, .duty_frac = 0.5});
  EXPECT_EQ(polygon_state(polygon, 0).angle_1_rad, 0);
  EXPECT_NEAR(polygon_state(polygon, 1.0 / 16).angle_1_rad, kPi / 8, 1e-15);
  EXPECT_NEAR(polygon_state(polygon, 1.0 / 8).angle_1_rad, -kPi / 4, 1e-15);
  EXPECT_NEAR(polygon_state(polygon, 3.0 / 16).angle_1_rad, -kPi / 8, 1e-15);
  EXPECT_NEAR(polygon_state(polygon, 0.25).angle_1_rad, 0, 1e-15);
  EXPECT_FALSE(polygon_state(polygon, 0.062).blanked);
  EXPECT_TRUE(polygon_state(polygon, 0.063).blanked);
  EXPECT_TRUE(polygon_state(polygon, 0.187).blanked);
  EXPECT_FALSE(polygon_state(polygon, 0.188).blanked);
}

TEST(Polygon, PhaseTurnsThePolygon) {
  const PolygonScanner polygon({.facets = 4, .rate_hz = 1, .phase_rad = kPi / 8});
  EXPECT_NEAR(polygon_state(polygon, 0).angle_1_rad, kPi / 8, 1e-15);
}

// The line of sight turns by twice the facet, along the line: from -x to +x at azimuth 0.
TEST(Polygon, LineOfSightTurnsTwiceTheFacet) {
  for (const double azimuth : {0.0, 0.7, kPi / 2}) {
    const PolygonScanner polygon({.facets = 8, .rate_hz = 1, .line_azimuth_rad = azimuth});
    for (double t = -0.05; t < 0.05; t += 0.01) {
      const double scan_angle = 2 * 2 * kPi * t;
      EXPECT_LT((line_of_sight(polygon, polygon_state(polygon, t)) - towards(scan_angle, azimuth).v).norm(),
                1e-14);
    }
  }
}

// Property: reflection by the resting facet and then by the turned one, at any incidence in the plane that
// the facet normals sweep, is what steer() does, and the frame turns all of it.
TEST(Polygon, IsTheExactReflection) {
  RandomCases random;
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = random.uniform(-4, 4);
    const PolygonScanner polygon({.facets = 12,
                                  .rate_hz = 3,
                                  .phase_rad = random.uniform(-9, 9),
                                  .line_azimuth_rad = azimuth,
                                  .frame_amplitude_rad = 0.3});
    const ScannerState state = polygon_state(polygon, random.uniform(0, 10));
    const Vector3d u(std::cos(azimuth), std::sin(azimuth), 0);
    const Vector3d v(-std::sin(azimuth), std::cos(azimuth), 0);
    const double incidence = random.uniform(-1, 1);
    const auto normal_at = [&](double turn) -> Vector3d {
      return std::sin(incidence + turn) * u + std::cos(incidence + turn) * Vector3d::UnitZ();
    };
    const Vector3d pixel = random.within(0.3).v;
    const Vector3d facet = reflected(reflected(pixel, normal_at(0)), normal_at(state.angle_1_rad));
    const Vector3d expected = turn_about(u, state.angle_2_rad) * facet;
    const Beam beam = beam_of(polygon, state, pixel);
    ASSERT_LT((beam.direction.v - expected).norm(), 2e-15) << "case " << i;
    EXPECT_EQ(beam.exit.v, Vector3d::Zero());
    const Vector3d los = std::sin(2 * state.angle_1_rad) * u +
                         std::cos(2 * state.angle_1_rad) * (std::cos(state.angle_2_rad) * Vector3d::UnitZ() -
                                                            std::sin(state.angle_2_rad) * v);
    ASSERT_LT((line_of_sight(polygon, state) - los).norm(), 2e-15);
  }
}

// At the nominal mount -y_L is up on the map: the frame begins at the top and comes down.
TEST(Polygon, FrameSwingsEvenlyFromTheTop) {
  const PolygonScanner polygon({.facets = 8, .rate_hz = 1, .frame_amplitude_rad = 0.1, .frame_rate_hz = 0.5});
  const double expected[] = {0.1, 0.05, 0, -0.05, -0.1, -0.05, 0, 0.05, 0.1};
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(polygon_state(polygon, 0.25 * i).angle_2_rad, expected[i], 1e-16);
  EXPECT_LT(line_of_sight(polygon, polygon_state(polygon, 0)).y(), -0.099);
}

TEST(Polygon, RefusesParametersOutOfRange) {
  EXPECT_THROW(PolygonScanner({.facets = 1}), UsageError);
  EXPECT_THROW(PolygonScanner({.facets = 1001}), UsageError);
  EXPECT_THROW(PolygonScanner({.rate_hz = 0}), UsageError);
  EXPECT_THROW(PolygonScanner({.rate_hz = HUGE_VAL}), UsageError);
  EXPECT_THROW(PolygonScanner({.phase_rad = std::nan("")}), UsageError);
  EXPECT_THROW(PolygonScanner({.line_azimuth_rad = std::nan("")}), UsageError);
  EXPECT_THROW(PolygonScanner({.duty_frac = 0}), UsageError);
  EXPECT_THROW(PolygonScanner({.duty_frac = 1.01}), UsageError);
  EXPECT_THROW(PolygonScanner({.frame_amplitude_rad = -0.1}), UsageError);
  EXPECT_THROW(PolygonScanner({.frame_rate_hz = 0}), UsageError);
  EXPECT_THROW(PolygonScanner({.facets = 4, .duty_frac = 1}), UsageError) << "reaches 90 deg";
  EXPECT_THROW(PolygonScanner({.facets = 8, .duty_frac = 1, .frame_amplitude_rad = 0.8}), UsageError);
  EXPECT_NO_THROW(PolygonScanner({.facets = 5, .duty_frac = 1}));
}

ScannerState estimated_at(const PolygonScanner& polygon, double t_s) {
  const PulseContext pulse{.time = {0, t_s}};
  return polygon.estimated_state(pulse, polygon.state(pulse));
}

// Four facets, one revolution per second: facet f is at its middle at t = f/4, and its line is 2 eps beside
// the nominal one, towards -y_L at azimuth 0, as with a positive angle of the frame.
TEST(Polygon, EachFacetHasItsTilt) {
  const std::vector<double> tilts = {0, 43e-6, -62e-6, 191e-6};
  const PolygonScanner polygon({.facets = 4, .rate_hz = 1, .duty_frac = 0.5, .facet_tilt_rad = tilts});
  for (int turn = 0; turn < 3; ++turn)
    for (std::size_t facet = 0; facet < 4; ++facet) {
      const Vector3d sight =
          line_of_sight(polygon, polygon_state(polygon, turn + 0.25 * static_cast<double>(facet)));
      EXPECT_NEAR(sight.y(), -std::sin(2 * tilts[facet]), 1e-15) << facet;
      EXPECT_NEAR(sight.x(), 0, 1e-15);
    }
  const PolygonScanner by_frame({.frame_amplitude_rad = 1e-3});
  EXPECT_LT(line_of_sight(by_frame, polygon_state(by_frame, 0)).y(), 0);
}

// Beside the middle the line is 2 eps cos(theta) from the nominal one, to third order: a bow of 2 eps (1 -
// cos).
TEST(Polygon, ATiltedFacetDrawsABow) {
  const double tilt = 1e-4;
  const PolygonScanner polygon(
      {.facets = 4, .rate_hz = 1, .duty_frac = 0.9, .facet_tilt_rad = {tilt, 0, 0, 0}});
  for (const double t_s : {-0.1, -0.03, 0.05, 0.1}) {
    const ScannerState state = polygon_state(polygon, t_s);
    EXPECT_NEAR(state.angle_1_rad, 2 * kPi * t_s, 1e-15);
    const Vector3d sight = line_of_sight(polygon, state);
    EXPECT_NEAR(sight.y(), -2 * tilt * std::cos(state.angle_1_rad), 10 * tilt * tilt * tilt);
    EXPECT_NEAR(std::atan2(sight.x(), sight.z()), 2 * state.angle_1_rad, 4 * tilt * tilt);
  }
}

// Property: the exact reflection by the tilted facet, in the frame that turns with psi.
TEST(Polygon, TiltedFacetsReflectExactly) {
  RandomCases random;
  for (int i = 0; i < 500; ++i) {
    const double azimuth = random.uniform(-4, 4);
    const double tilt = random.uniform(-0.1, 0.1);
    const PolygonScanner polygon({.facets = 12,
                                  .rate_hz = 3,
                                  .line_azimuth_rad = azimuth,
                                  .frame_amplitude_rad = 0.3,
                                  .facet_tilt_rad = std::vector<double>(12, tilt)});
    const ScannerState state = polygon_state(polygon, random.uniform(0, 10));
    const Vector3d u(std::cos(azimuth), std::sin(azimuth), 0);
    const Vector3d v(-std::sin(azimuth), std::cos(azimuth), 0);
    const Vector3d m = turn_about(v, state.angle_1_rad) * turn_about(u, tilt) * Vector3d::UnitZ();
    const Vector3d pixel = random.within(0.1).v;
    const Vector3d expected =
        turn_about(u, state.angle_2_rad) * reflected(reflected(pixel, Vector3d::UnitZ()), m);
    ASSERT_LT((beam_of(polygon, state, pixel).direction.v - expected).norm(), 1e-14);
  }
}

TEST(Polygon, FacetsWithoutATiltReflectAsBefore) {
  const PolygonScanner plain({.frame_amplitude_rad = 0.1});
  const PolygonScanner flat({.frame_amplitude_rad = 0.1, .facet_tilt_rad = std::vector<double>(48, 0)});
  EXPECT_TRUE(plain.is_known());
  for (const double t_s : {0.0, 0.123, 3.4})
    EXPECT_LT(
        (line_of_sight(plain, polygon_state(plain, t_s)) - line_of_sight(flat, polygon_state(flat, t_s)))
            .norm(),
        1e-15);
}

TEST(Polygon, TheLanderKnowsTheTiltsOfACalibratedScanner) {
  PolygonParameters parameters{.facets = 4, .rate_hz = 1, .facet_tilt_rad = {1e-3, 2e-3, 3e-3, 4e-3}};
  const PolygonScanner unknown(parameters);
  parameters.facet_tilt_known = true;
  const PolygonScanner known(parameters);
  parameters.encoder_harmonics = {{.order = 1, .amplitude_rad = 1e-4, .phase_rad = kPi / 2}};
  const PolygonScanner misread(parameters);
  EXPECT_FALSE(unknown.is_known());
  EXPECT_TRUE(known.is_known());
  EXPECT_FALSE(misread.is_known());
  EXPECT_NEAR(line_of_sight(unknown, estimated_at(unknown, 0.25)).y(), 0, 1e-15);
  const Vector3d sight = line_of_sight(misread, estimated_at(misread, 0.25));
  EXPECT_NEAR(sight.y(), line_of_sight(known, polygon_state(known, 0.25)).y(), 1e-9);
}

// The encoder of the drum counts whole turns: an eccentric disc reads the same error once a revolution.
TEST(Polygon, TheEncoderOfTheDrumHasItsHarmonics) {
  const PolygonScanner polygon(
      {.facets = 4,
       .rate_hz = 1,
       .frame_amplitude_rad = 0.1,
       .encoder_harmonics = {{.order = 1, .amplitude_rad = 1e-3},
                             {.axis = 2, .order = 3, .amplitude_rad = 2e-3, .phase_rad = 0.5}}});
  for (const double t_s : {0.0, 0.1, 0.25, 0.3, 0.7}) {
    const ScannerState truth = polygon_state(polygon, t_s);
    const ScannerState read = estimated_at(polygon, t_s);
    EXPECT_NEAR(read.angle_1_rad - truth.angle_1_rad, 1e-3 * std::sin(2 * kPi * t_s), 1e-15);
    EXPECT_NEAR(read.angle_2_rad - truth.angle_2_rad, 2e-3 * std::sin(3 * truth.angle_2_rad + 0.5), 1e-15);
    EXPECT_EQ(read.blanked, truth.blanked);
  }
}

// 1000 facets: the sample sigma is within 5/sqrt(2000) = 11 % of the true one.
TEST(Polygon, DrawsTilts) {
  const auto tilt = [](const PolygonScanner& polygon, int facet) {
    return std::asin(-line_of_sight(polygon, polygon_state(polygon, facet / 1000.0)).y()) / 2;
  };
  PolygonParameters parameters{.facets = 1000, .rate_hz = 1, .facet_tilt_sigma_rad = 1e-4, .seed = 5};
  const PolygonScanner drawn(parameters);
  double squares = 0;
  for (int facet = 0; facet < 1000; ++facet) squares += std::pow(tilt(drawn, facet) / 1e-4, 2);
  EXPECT_NEAR(std::sqrt(squares / 1000), 1, 0.11);
  parameters.facet_tilt_rad = std::vector<double>(1000, 1e-3);
  EXPECT_NEAR(tilt(PolygonScanner(parameters), 7), 1e-3 + tilt(drawn, 7), 1e-12);
  parameters.seed = 6;
  EXPECT_NE(tilt(PolygonScanner(parameters), 7), 1e-3 + tilt(drawn, 7));
}

TEST(Polygon, RefusesTiltsOutOfRange) {
  EXPECT_THROW(PolygonScanner({.facets = 4, .facet_tilt_rad = {0, 0, 0}}), UsageError);
  EXPECT_THROW(PolygonScanner({.facets = 2, .duty_frac = 0.2, .facet_tilt_rad = {0, 0.11}}), UsageError);
  EXPECT_THROW(PolygonScanner({.facet_tilt_sigma_rad = -1e-6}), UsageError);
  EXPECT_THROW(PolygonScanner({.facet_tilt_sigma_rad = 0.011}), UsageError);
  EXPECT_THROW(PolygonScanner({.encoder_harmonics = {{.order = 0}}}), UsageError);
}

}  // namespace
}  // namespace landfall
