// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/descent_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "base/geometry/rotation_vector.h"
#include "refusal.h"

namespace landfall {
namespace {

RigidBodyState turned(const Eigen::Vector3d& phi,
                      const Eigen::Vector3d& rate_radps = Eigen::Vector3d::Zero()) {
  RigidBodyState state;
  state.attitude = quaternion_of(phi);
  state.rate_radps.v = rate_radps;
  return state;
}

template <class... Arguments>
std::string message_of(const Arguments&... arguments) {
  return refusal([&] { require_valid(arguments...); });
}

TEST(DescentThrust, CarriesTheWeightAndCorrectsTheRate) {
  const DescentThrust thrust{.descent_rate_mps = 20, .gain_per_s = 0.5, .max_n = 2000};
  RigidBodyState state;
  state.velocity_mps.v = Eigen::Vector3d(5, 5, -20);
  EXPECT_EQ(thrust_of(thrust, 1.3, 500, state).v, Eigen::Vector3d(0, 0, 650));
  state.velocity_mps.v.z() = -22;  // too fast: 1 m/s^2 more
  EXPECT_EQ(thrust_of(thrust, 1.3, 500, state).v, Eigen::Vector3d(0, 0, 1150));
  state.velocity_mps.v.z() = -16;  // too slow: the engine cannot pull
  EXPECT_EQ(thrust_of(thrust, 1.3, 500, state).v, Eigen::Vector3d::Zero());
  state.velocity_mps.v.z() = -40;
  EXPECT_EQ(thrust_of(thrust, 1.3, 500, state).v, Eigen::Vector3d(0, 0, 2000));
}

TEST(DescentThrust, TiltedItPushesHarderAndUpsideDownNotAtAll) {
  RigidBodyState state = turned({std::numbers::pi / 3, 0, 0});
  state.velocity_mps.v.z() = -23;
  EXPECT_NEAR(thrust_of({}, 1, 500, state).v.z(), 1000, 1e-10);
  state.attitude = quaternion_of({std::numbers::pi, 0, 0});
  EXPECT_EQ(thrust_of({}, 1, 500, state).v.z(), 0);
}

TEST(AttitudeControl, FiresBeyondTheDeadbandOnly) {
  const AttitudeControl control{.deadband_rad = 0.01, .rate_gain_s = 2, .torque_nm = {10, 20, 30}};
  EXPECT_EQ(torque_of(control, turned({0.0099, -0.0099, 0})).v, Eigen::Vector3d::Zero());
  EXPECT_EQ(torque_of(control, turned({0.0101, 0, 0})).v, Eigen::Vector3d(-10, 0, 0));
  EXPECT_EQ(torque_of(control, turned({0, -0.0101, 0.02})).v, Eigen::Vector3d(0, 20, -30));
  // The rate tells where the body is going: 0.004 + 2 * 0.0031 > 0.01.
  EXPECT_EQ(torque_of(control, turned({0, 0.004, 0}, {0, 0.0031, 0})).v, Eigen::Vector3d(0, -20, 0));
  EXPECT_EQ(torque_of(control, turned({0, 0.004, 0}, {0, 0.0029, 0})).v, Eigen::Vector3d::Zero());
}

TEST(AttitudeControl, ErrorIsAgainstTheCommandAndSeenInTheBody) {
  const AttitudeControl control{.command = {0, 0, std::numbers::pi / 2}, .torque_nm = {1, 2, 3}};
  RigidBodyState state;
  state.attitude = Eigen::Quaterniond(rotation_matrix(control.command));
  EXPECT_EQ(torque_of(control, state).v, Eigen::Vector3d::Zero());
  // Turned on about x_D, which is -y_B.
  state.attitude = quaternion_of({0.1, 0, 0}) * state.attitude;
  EXPECT_EQ(torque_of(control, state).v, Eigen::Vector3d(0, 2, 0));
}

TEST(DescentControl, RefusesBadNumbers) {
  EXPECT_THAT(message_of(DescentThrust{.max_n = -1}, 0.01), testing::HasSubstr("thrust/max_n: -1"));
  EXPECT_THAT(message_of(DescentThrust{.gain_per_s = 11}, 0.1), testing::HasSubstr("thrust/gain_per_s: 11"));
  EXPECT_THAT(message_of(DescentThrust{.descent_rate_mps = std::nan("")}, 0.1),
              testing::HasSubstr("descent_rate_mps"));
  EXPECT_THAT(message_of(AttitudeControl{.deadband_rad = -std::numbers::pi}),
              testing::HasSubstr("deadband_deg: -180 "));
  EXPECT_THAT(message_of(AttitudeControl{.rate_gain_s = HUGE_VAL}), testing::HasSubstr("rate_gain_s: inf"));
  EXPECT_THAT(message_of(AttitudeControl{.torque_nm = {1, -2, 3}}), testing::HasSubstr("torque_nm/1: -2"));
  EXPECT_THAT(message_of(AttitudeControl{.command = {0, std::nan(""), 0}}),
              testing::HasSubstr("command_rpy_deg/1: nan"));
}

}  // namespace
}  // namespace landfall
