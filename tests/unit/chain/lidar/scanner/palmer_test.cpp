// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/palmer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

ScannerState palmer_state(const Palmer& palmer, double t_s) { return palmer.state({.time = {0, t_s}}); }

// Normal incidence: a circular cone of half angle 2 tilt, exactly, run through at an even pace.
TEST(Palmer, CircleAtNormalIncidence) {
  for (const double tilt : {0.01, 0.2, 0.7}) {
    const Palmer palmer({.tilt_rad = tilt, .incidence_rad = 0, .rate_hz = 1});
    for (double t = 0; t < 2; t += 0.07)
      EXPECT_LT((line_of_sight(palmer, palmer_state(palmer, t)) - towards(2 * tilt, 2 * kPi * t - kPi / 2).v)
                    .norm(),
                5e-15);
  }
}

TEST(Palmer, ReportsTheMotorsTurn) {
  const Palmer palmer({.rate_hz = 2, .phase_rad = kPi / 2});
  EXPECT_NEAR(palmer_state(palmer, 0).angle_1_rad, kPi / 2, 1e-15);
  EXPECT_NEAR(palmer_state(palmer, 0.125).angle_1_rad, kPi, 1e-15);
  EXPECT_NEAR(palmer_state(palmer, 0.5).angle_1_rad, kPi / 2, 1e-14);
  EXPECT_EQ(palmer_state(palmer, 0.125).angle_2_rad, 0);
}

// 45 deg: half axes 2 tilt in the plane of incidence, sqrt(2) tilt across, to first order in the tilt.
TEST(Palmer, EllipseToFirstOrder) {
  const double tilt = 1e-5;
  const Palmer palmer({.tilt_rad = tilt, .rate_hz = 1});
  for (double t = 0; t < 1; t += 0.03) {
    const Vector3d los = line_of_sight(palmer, palmer_state(palmer, t));
    EXPECT_NEAR(los.x(), std::numbers::sqrt2 * tilt * std::sin(2 * kPi * t), 5 * tilt * tilt);
    EXPECT_NEAR(los.y(), -2 * tilt * std::cos(2 * kPi * t), 5 * tilt * tilt);
  }
}

// Property: against rotation matrices written out by hand, for pixels off the boresight too.
TEST(Palmer, IsTheExactReflection) {
  RandomCases random;
  for (int i = 0; i < 2000; ++i) {
    const double incidence = random.uniform(0, 1.2);
    const double tilt = random.uniform(0, 0.3);
    const double azimuth = random.uniform(-4, 4);
    const double phase = random.uniform(-9, 9);
    const double t = random.uniform(0, 10);
    const Palmer palmer({.tilt_rad = tilt,
                         .incidence_rad = incidence,
                         .fold_azimuth_rad = azimuth,
                         .rate_hz = 3,
                         .phase_rad = phase});
    // The axis along z, the normal tilted towards -y and turned about z; then the axis is laid back by the
    // incidence, about x, and the whole is turned by the azimuth.
    const double phi = phase + 2 * kPi * 3 * t;
    const Vector3d about_z(std::sin(tilt) * std::sin(phi), -std::sin(tilt) * std::cos(phi), std::cos(tilt));
    const Eigen::Matrix3d lay_back{{1, 0, 0},
                                   {0, std::cos(incidence), std::sin(incidence)},
                                   {0, -std::sin(incidence), std::cos(incidence)}};
    const Eigen::Matrix3d fold{
        {std::cos(azimuth), -std::sin(azimuth), 0}, {std::sin(azimuth), std::cos(azimuth), 0}, {0, 0, 1}};
    const Vector3d normal = fold * (lay_back * about_z);
    const Vector3d axis = fold * (lay_back * Vector3d::UnitZ());
    const Vector3d pixel = random.within(0.1).v;
    const Beam beam = beam_of(palmer, palmer_state(palmer, t), pixel);
    ASSERT_LT((beam.direction.v - reflected(reflected(pixel, axis), normal)).norm(), 2e-13) << "case " << i;
    EXPECT_EQ(beam.exit.v, Vector3d::Zero());
  }
}

TEST(Palmer, RefusesParametersOutOfRange) {
  EXPECT_THROW(Palmer({.tilt_rad = -0.01}), UsageError);
  EXPECT_THROW(Palmer({.tilt_rad = kPi / 4, .incidence_rad = kPi / 4}), UsageError);
  EXPECT_THROW(Palmer({.tilt_rad = std::nan("")}), UsageError);
  EXPECT_THROW(Palmer({.incidence_rad = kPi / 2}), UsageError);
  EXPECT_THROW(Palmer({.fold_azimuth_rad = HUGE_VAL}), UsageError);
  EXPECT_THROW(Palmer({.rate_hz = 0}), UsageError);
  EXPECT_THROW(Palmer({.phase_rad = std::nan("")}), UsageError);
}

}  // namespace
}  // namespace landfall
