// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/core/error.h"
#include "chain/lidar/scanner/gimbal.h"
#include "chain/lidar/scanner/palmer.h"
#include "chain/lidar/scanner/scanner.h"
#include "refusal.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

TEST(Flash, LeavesThePixelsAlone) {
  const Flash flash;
  const std::array<Direction<LidarFrame>, 2> pixels{{{{0.6, 0, 0.8}}, {{0, -0.6, 0.8}}}};
  std::array<Beam, 2> beams{Beam{.exit = {{1, 1, 1}}, .lost = true}, Beam{}};
  const ScannerState state = flash.state({.time = {3, 0.5}, .aim = Direction<LidarFrame>{{0, 0.6, 0.8}}});
  flash.steer(state, pixels, beams);
  EXPECT_EQ(state.angle_1_rad, 0);
  EXPECT_EQ(state.angle_2_rad, 0);
  EXPECT_FALSE(state.blanked);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(beams[i].direction, pixels[i]);
    EXPECT_EQ(beams[i].exit, Point<LidarFrame>{});
    EXPECT_FALSE(beams[i].lost);
  }
}

TEST(Gimbal, RestsWithoutAnAim) {
  const Gimbal gimbal({});
  const ScannerState state = gimbal.state({});
  const Vector3d pixel = towards(0.2, 1).v;
  EXPECT_EQ(beam_of(gimbal, state, pixel).direction.v, pixel);
  EXPECT_EQ(beam_of(gimbal, state, pixel).exit.v, Vector3d::Zero());
  EXPECT_TRUE(gimbal.is_known());
}

// The outer axis, x, by +30 deg takes the boresight to -y; the inner one, y, takes it to +x.
TEST(Gimbal, Axes) {
  const Gimbal gimbal({.max_deflection_rad = 1});
  EXPECT_LT((line_of_sight(gimbal, {.angle_1_rad = kPi / 6}) - Vector3d(0, -0.5, std::sqrt(0.75))).norm(),
            1e-15);
  EXPECT_LT((line_of_sight(gimbal, {.angle_2_rad = kPi / 6}) - Vector3d(0.5, 0, std::sqrt(0.75))).norm(),
            1e-15);
}

// Property: exact aim, and the camera turns as the product of two axis rotations, inner first.
TEST(Gimbal, TurnsTheWholeCamera) {
  RandomCases random;
  const Gimbal gimbal({.max_deflection_rad = 1.5});
  for (int i = 0; i < 5000; ++i) {
    const auto aim = random.within(1.5);
    const ScannerState state = gimbal.state({.aim = aim});
    ASSERT_LE((line_of_sight(gimbal, state) - aim.v).cwiseAbs().maxCoeff(), 1e-15) << "case " << i;
    const Vector3d pixel = random.within(0.3).v;
    const Vector3d turned = turn_about(Vector3d::UnitX(), state.angle_1_rad) *
                            (turn_about(Vector3d::UnitY(), state.angle_2_rad) * pixel);
    ASSERT_LT((beam_of(gimbal, state, pixel).direction.v - turned).norm(), 1e-15);
  }
}

TEST(Gimbal, ImageTurnsByHalfTheProduct) {
  const Gimbal gimbal({});
  for (const double a : {-0.02, 0.01, 0.03})
    for (const double b : {-0.03, 0.02})
      EXPECT_NEAR(image_rotation(gimbal, {.angle_1_rad = a, .angle_2_rad = b}), a * b / 2, 1e-6);
}

TEST(Gimbal, BlanksAndSettlesAfterAStep) {
  const MechanismTimingParameters timing{.turnaround_time_s = 0.01, .settle_time_s = 0.02};
  const Gimbal gimbal({.timing = timing});
  const auto from = towards(0.1, 2);
  const auto to = towards(0.2, 5);
  const ScannerState at_once = gimbal.state({.aim = to, .since_jump_s = 0, .aim_before_jump = from});
  EXPECT_TRUE(at_once.blanked);
  EXPECT_LT((line_of_sight(gimbal, at_once) - from.v).norm(), 1e-15);
  const ScannerState later = gimbal.state({.aim = to, .since_jump_s = 0.015, .aim_before_jump = from});
  EXPECT_FALSE(later.blanked);
  const double left = MechanismTiming(timing).step_left(0.015);
  const TiltAngles a = gimbal_angles(from);
  const TiltAngles b = gimbal_angles(to);
  EXPECT_NEAR(later.angle_1_rad, b.angle_1_rad + left * (a.angle_1_rad - b.angle_1_rad), 1e-16);
  EXPECT_NEAR(later.angle_2_rad, b.angle_2_rad + left * (a.angle_2_rad - b.angle_2_rad), 1e-16);
}

TEST(Gimbal, RefusesAnAimBeyondItsReach) {
  const Gimbal gimbal({});
  EXPECT_NO_THROW(static_cast<void>(gimbal.state({.aim = towards(29.999 * kDegree, 0)})));
  EXPECT_THAT(refusal<FormatError>([&] {
                return gimbal.state({.time = {17, 0}, .aim = towards(31 * kDegree, 0)});
              }),
              testing::HasSubstr("pulse 17 aims 31 degrees"));
}

TEST(Gimbal, RefusesParametersOutOfRange) {
  EXPECT_THROW(Gimbal({.max_deflection_rad = 0}), UsageError);
  EXPECT_THROW(Gimbal({.max_deflection_rad = kPi / 2}), UsageError);
  EXPECT_THROW(Gimbal({.max_deflection_rad = std::nan("")}), UsageError);
  EXPECT_THROW(Gimbal({.timing = {.settle_time_s = -1}}), UsageError);
}

TEST(Gimbal, ItsEncodersHaveHarmonics) {
  const Gimbal gimbal(
      {.encoder_harmonics = {{.axis = 2, .order = 4, .amplitude_rad = 1e-3, .phase_rad = 0.3}}});
  EXPECT_FALSE(gimbal.is_known());
  const PulseContext pulse{.aim = towards(0.2, 0)};
  const ScannerState truth = gimbal.state(pulse);
  const ScannerState read = gimbal.estimated_state(pulse, truth);
  EXPECT_EQ(read.angle_1_rad, truth.angle_1_rad);
  EXPECT_NEAR(read.angle_2_rad, 0.2 + 1e-3 * std::sin(4 * 0.2 + 0.3), 1e-15);
  EXPECT_THROW(Gimbal({.encoder_harmonics = {{.axis = 3}}}), UsageError);
}

TEST(Gimbal, BlanksUntilItHasCaughtUp) {
  const Gimbal gimbal({.timing = {.max_acceleration_radps2 = 100}});
  EXPECT_TRUE(gimbal.needs().jumps);
  EXPECT_TRUE(gimbal.needs().motion);
  const auto left = towards(0.1, kPi);
  const auto right = towards(0.1, 0);
  PulseContext pulse{
      .aim = right, .since_jump_s = 0.088, .jump_aims = JumpAims{left, left, right, right, 1e-3}};
  EXPECT_TRUE(gimbal.state(pulse).blanked);  // 2 sqrt(0.2/100) = 89.4 ms after the last pulse before the jump
  pulse.since_jump_s = 0.089;
  EXPECT_FALSE(gimbal.state(pulse).blanked);
  pulse.jump_aims.reset();
  EXPECT_FALSE(gimbal.state(pulse).blanked);
}

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
