// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "base/geometry/rotation_vector.h"
#include "chain/lidar/trajectory/descent_control.h"
#include "chain/lidar/trajectory/rigid_body.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

std::string rigid_body_message(const RigidBody& body) {
  return refusal([&] { const RigidBodyMotion motion(body); });
}

RigidBodyState propagate(const RigidBodyMotion& motion, RigidBodyState state, const Load& load, int steps,
                         double step_s) {
  for (int i = 0; i < steps; ++i) state = motion.after(step_s, state, load);
  return state;
}

double rotational_energy(const RigidBody& body, const RigidBodyState& s) {
  return 0.5 * s.rate_radps.v.dot(body.inertia_kgm2 * s.rate_radps.v);
}

Eigen::Vector3d angular_momentum(const RigidBody& body, const RigidBodyState& s) {
  return s.attitude * (body.inertia_kgm2 * s.rate_radps.v);
}

double energy(const RigidBody& body, const RigidBodyState& s, double gravity_mps2) {
  return rotational_energy(body, s) + 0.5 * body.mass_kg * s.velocity_mps.v.squaredNorm() +
         body.mass_kg * gravity_mps2 * s.position_m.v.z();
}

TEST(RigidBody, FallsFreely) {
  const RigidBodyMotion motion({});
  const RigidBodyState start{.position_m = {{1, 2, 500}}, .velocity_mps = {{3, -4, -23}}};
  const RigidBodyState end = motion.after(7, start, {.gravity_mps2 = {{0, 0, -1.315}}});
  EXPECT_LT((end.position_m.v - Eigen::Vector3d(22, -26, 500 - 161 - 0.5 * 1.315 * 49)).norm(), 1e-12);
  EXPECT_LT((end.velocity_mps.v - Eigen::Vector3d(3, -4, -23 - 7 * 1.315)).norm(), 1e-13);
  EXPECT_EQ(end.attitude.coeffs(), start.attitude.coeffs());
}

// A force turns with the body: 500 N on 500 kg along x_B, yawed by 90 deg, pushes along y_D.
TEST(RigidBody, ForceIsSeenInTheBody) {
  const RigidBodyMotion motion({.mass_kg = 500});
  RigidBodyState start;
  start.attitude = quaternion_of({0, 0, std::acos(0.0)});
  const RigidBodyState end = motion.after(2, start, {.force_n = {{500, 0, 0}}});
  EXPECT_LT((end.position_m.v - Eigen::Vector3d(0, 2, 0)).norm(), 1e-14);
}

TEST(RigidBody, TorqueAboutAPrincipalAxisTurnsEvenlyFaster) {
  const RigidBodyMotion motion({});
  RigidBodyState start;
  start.rate_radps.v.z() = 0.1;
  const RigidBodyState end = motion.after(3, start, {.torque_nm = {{0, 0, 40}}});
  EXPECT_NEAR(end.rate_radps.v.z(), 0.4, 1e-14);
  EXPECT_LT((rotation_vector(end.attitude) - Eigen::Vector3d(0, 0, 0.75)).norm(), 1e-13);
}

// Free symmetric body (I1 = I2): R(t) = exp(t L / I1) R(0) exp(t (1 - I3/I1) omega3 z), L in D.
TEST(RigidBody, SymmetricBodyPrecesses) {
  const RigidBody body{.inertia_kgm2 = Eigen::Vector3d(300, 300, 450).asDiagonal()};
  RigidBodyState start{.rate_radps = {{0.3, -0.1, 0.4}}};
  start.attitude = quaternion_of({0.5, 1, -0.2});
  const RigidBodyState end = propagate(RigidBodyMotion(body), start, {}, 1000, 0.1);
  const Eigen::Quaterniond expected = quaternion_of(100 / 300.0 * angular_momentum(body, start)) *
                                      start.attitude * quaternion_of({0, 0, 100 * (1 - 450 / 300.0) * 0.4});
  EXPECT_LT(rotation_vector(end.attitude.conjugate() * expected).norm(), 1e-10);
}

// 100 s without force or torque, and an unevenly shaped body: nothing that must stay changes by 1e-9.
TEST(RigidBody, KeepsEnergyAndMomentumOfAnAsymmetricBody) {
  RigidBody body;
  body.inertia_kgm2 << 300, 20, -15, 20, 420, 35, -15, 35, 510;
  const RigidBodyState start{{{10, 20, 30}}, {{1, -2, 3}}, quaternion_of({1, 1, 0}), {{0.02, 0.5, 0.01}}};
  RigidBodyState state = start;
  const RigidBodyMotion motion(body);
  const Eigen::Vector3d L = angular_momentum(body, start);
  double farthest_rate = 0;
  for (int i = 0; i < 10000; ++i) {
    state = motion.after(0.01, state, {});
    ASSERT_LT((angular_momentum(body, state) - L).norm(), 1e-9 * L.norm());
    ASSERT_NEAR(rotational_energy(body, state) / rotational_energy(body, start), 1, 1e-9);
    ASSERT_EQ(state.velocity_mps.v, start.velocity_mps.v);
    farthest_rate = std::max(farthest_rate, (state.rate_radps.v - start.rate_radps.v).norm());
  }
  EXPECT_GT(farthest_rate, 0.3) << "turning about the middle axis it must tumble";
}

TEST(RigidBody, RefusesWhatNoBodyHas) {
  EXPECT_THAT(rigid_body_message({.mass_kg = 0}),
              testing::HasSubstr("mass_kg: 0 is not finite and positive"));
  EXPECT_THAT(rigid_body_message({.inertia_kgm2 = Eigen::Vector3d(1, 2, 3.1).asDiagonal()}),
              testing::HasSubstr("at most the sum of the other two"));
  EXPECT_THAT(rigid_body_message({.inertia_kgm2 = Eigen::Vector3d(1, 0, 1).asDiagonal()}),
              testing::HasSubstr("0 is not positive"));
  EXPECT_THAT(rigid_body_message({.inertia_kgm2 = Eigen::Vector3d(1, std::nan(""), 1).asDiagonal()}),
              testing::HasSubstr("not finite"));
  RigidBody skew;
  skew.inertia_kgm2(0, 1) = 5;
  EXPECT_THAT(rigid_body_message(skew), testing::HasSubstr("must be symmetric"));
}

// Random bodies that tumble and fall for 20 s: energy, angular momentum and the path of the centre of mass.
TEST(RigidBodyProperty, TumblingBodiesKeepWhatMustStay) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Eigen::Vector3d(unit(random), unit(random), unit(random)); };
  for (int i = 0; i < 50; ++i) {
    // The inertia of four point masses fulfils every condition on an inertia.
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (int j = 0; j < 4; ++j) {
      const Eigen::Vector3d r = 2 * vector();
      inertia += 100 * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
    }
    const RigidBody body{.mass_kg = 400, .inertia_kgm2 = inertia};
    const RigidBodyState start{{100 * vector()}, {vector()}, quaternion_of(3 * vector()), {0.5 * vector()}};
    const RigidBodyState end =
        propagate(RigidBodyMotion(body), start, {.gravity_mps2 = {{0, 0, -1.6}}}, 200, 0.1);
    const Eigen::Vector3d L = angular_momentum(body, start);
    EXPECT_LT((angular_momentum(body, end) - L).norm(), 1e-9 * L.norm());
    EXPECT_NEAR(energy(body, end, 1.6) / energy(body, start, 1.6), 1, 1e-9);
    EXPECT_LT((end.position_m.v -
               (start.position_m.v + 20 * start.velocity_mps.v - Eigen::Vector3d(0, 0, 0.5 * 1.6 * 400)))
                  .norm(),
              1e-9);
  }
}

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
