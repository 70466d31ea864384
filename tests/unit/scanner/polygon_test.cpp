// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/polygon.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

ScannerState at(const Polygon& polygon, double t_s) { return polygon.state({.time = {0, t_s}}); }

// Four facets, one revolution per second: a facet is used for 1/4 s, +-45 deg of turn, of which half.
TEST(Polygon, FacetAfterFacet) {
  const Polygon polygon({.facets = 4, .rate_hz = 1, .duty_frac = 0.5});
  EXPECT_EQ(at(polygon, 0).angle_1_rad, 0);
  EXPECT_NEAR(at(polygon, 1.0 / 16).angle_1_rad, kPi / 8, 1e-15);
  EXPECT_NEAR(at(polygon, 1.0 / 8).angle_1_rad, -kPi / 4, 1e-15);
  EXPECT_NEAR(at(polygon, 3.0 / 16).angle_1_rad, -kPi / 8, 1e-15);
  EXPECT_NEAR(at(polygon, 0.25).angle_1_rad, 0, 1e-15);
  EXPECT_FALSE(at(polygon, 0.062).blanked);
  EXPECT_TRUE(at(polygon, 0.063).blanked);
  EXPECT_TRUE(at(polygon, 0.187).blanked);
  EXPECT_FALSE(at(polygon, 0.188).blanked);
}

TEST(Polygon, PhaseTurnsThePolygon) {
  const Polygon polygon({.facets = 4, .rate_hz = 1, .phase_rad = kPi / 8});
  EXPECT_NEAR(at(polygon, 0).angle_1_rad, kPi / 8, 1e-15);
}

// The line of sight turns by twice the facet, along the line: from -x to +x at azimuth 0.
TEST(Polygon, LineOfSightTurnsTwiceTheFacet) {
  for (const double azimuth : {0.0, 0.7, kPi / 2}) {
    const Polygon polygon({.facets = 8, .rate_hz = 1, .line_azimuth_rad = azimuth});
    for (double t = -0.05; t < 0.05; t += 0.01) {
      const double scan_angle = 2 * 2 * kPi * t;
      EXPECT_LT((line_of_sight(polygon, at(polygon, t)) - towards(scan_angle, azimuth).v).norm(), 1e-14);
    }
  }
}

// Property: reflection by the resting facet and then by the turned one, at any incidence in the plane that
// the facet normals sweep, is what steer() does, and the frame turns all of it.
TEST(Polygon, IsTheExactReflection) {
  RandomCases random;
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = random.uniform(-4, 4);
    const Polygon polygon({.facets = 12,
                           .rate_hz = 3,
                           .phase_rad = random.uniform(-9, 9),
                           .line_azimuth_rad = azimuth,
                           .frame_amplitude_rad = 0.3});
    const ScannerState state = at(polygon, random.uniform(0, 10));
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
  const Polygon polygon({.facets = 8, .rate_hz = 1, .frame_amplitude_rad = 0.1, .frame_rate_hz = 0.5});
  const double expected[] = {0.1, 0.05, 0, -0.05, -0.1, -0.05, 0, 0.05, 0.1};
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(at(polygon, 0.25 * i).angle_2_rad, expected[i], 1e-16);
  EXPECT_LT(line_of_sight(polygon, at(polygon, 0)).y(), -0.099);
}

TEST(Polygon, RefusesParametersOutOfRange) {
  EXPECT_THROW(Polygon({.facets = 1}), UsageError);
  EXPECT_THROW(Polygon({.facets = 1001}), UsageError);
  EXPECT_THROW(Polygon({.rate_hz = 0}), UsageError);
  EXPECT_THROW(Polygon({.rate_hz = HUGE_VAL}), UsageError);
  EXPECT_THROW(Polygon({.phase_rad = std::nan("")}), UsageError);
  EXPECT_THROW(Polygon({.line_azimuth_rad = std::nan("")}), UsageError);
  EXPECT_THROW(Polygon({.duty_frac = 0}), UsageError);
  EXPECT_THROW(Polygon({.duty_frac = 1.01}), UsageError);
  EXPECT_THROW(Polygon({.frame_amplitude_rad = -0.1}), UsageError);
  EXPECT_THROW(Polygon({.frame_rate_hz = 0}), UsageError);
  EXPECT_THROW(Polygon({.facets = 4, .duty_frac = 1}), UsageError) << "reaches 90 deg";
  EXPECT_THROW(Polygon({.facets = 8, .duty_frac = 1, .frame_amplitude_rad = 0.8}), UsageError);
  EXPECT_NO_THROW(Polygon({.facets = 5, .duty_frac = 1}));
}

}  // namespace
}  // namespace landfall
