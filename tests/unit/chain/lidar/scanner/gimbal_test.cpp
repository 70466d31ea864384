// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/gimbal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "refusal.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

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
  const ScannerState read = gimbal.believed_state(pulse, truth);
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

}  // namespace
}  // namespace landfall
