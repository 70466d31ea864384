// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/dynamics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/core/error.h"
#include "base/geometry/rotation_vector.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;

constexpr DescentThrust kNoEngine{.max_n = 0};
const AttitudeControl kNoThrusters{.torque_nm = Eigen::Vector3d::Zero()};

Eigen::Vector3d turn(const Pose& pose) { return rotation_vector(Eigen::Quaterniond(pose.rotation.m)); }

std::string dynamics_message(const DynamicsParameters& parameters) {
  return refusal([&] { const DynamicsTrajectory trajectory(parameters); });
}

// Times on and between the control times, over 100 s and 9 km.
TEST(Dynamics, FreeFallIsExact) {
  const DynamicsTrajectory fall({.position_m = {{3, 4, 500}},
                                 .velocity_mps = {{1, -2, -23}},
                                 .thrust = kNoEngine,
                                 .attitude_control = kNoThrusters,
                                 .duration_s = 100});
  for (const double t : {0.0, 0.003, 0.01, 1.2345, 77.777, 100.0}) {
    const Eigen::Vector3d expected(3 + t, 4 - 2 * t, 500 - 23 * t - 0.5 * 1.315 * t * t);
    EXPECT_LT((fall.pose(t).position.v - expected).norm(), 1e-12 * expected.norm()) << "at " << t;
    EXPECT_LT((fall.nominal_pose(t).position.v - expected).norm(), 1e-11) << "at " << t;
    EXPECT_EQ(fall.pose(t).rotation.m, Eigen::Matrix3d::Identity());
  }
}

TEST(Dynamics, GoesThroughItsStatesAndEndsAtTheLast) {
  const DynamicsTrajectory tumbling({.rate_radps = {{0.2, 0.3, -0.1}},
                                     .attitude_control = kNoThrusters,
                                     .control_period_s = 0.03,
                                     .duration_s = 2});
  ASSERT_EQ(tumbling.states().size(), 68U);
  EXPECT_EQ(tumbling.epoch_s(), 0);
  EXPECT_DOUBLE_EQ(tumbling.end_time_s(), 2.01);
  for (std::size_t k = 0; k < tumbling.states().size(); ++k) {
    const Pose pose = tumbling.pose(0.03 * static_cast<double>(k));
    EXPECT_LT((pose.position.v - tumbling.states()[k].position_m.v).norm(), 1e-12);
    EXPECT_LT((pose.rotation.m - tumbling.states()[k].attitude.toRotationMatrix()).norm(), 1e-14);
  }
  EXPECT_THROW(static_cast<void>(tumbling.pose(2.011)), FormatError);
  EXPECT_THROW(static_cast<void>(tumbling.pose(-2e-9)), FormatError);
  EXPECT_NO_THROW(static_cast<void>(tumbling.pose(-0.9e-9)));
}

/// The largest error of a pose between control times, against the motion integrated to that very time; the
/// body is asymmetric, turns at 1 rad/s and is pushed along its z axis.
Eigen::Vector2d interpolation_error(double control_period_s) {
  const DynamicsParameters parameters{.body = {.inertia_kgm2 = Eigen::Vector3d(300, 400, 500).asDiagonal()},
                                      .rate_radps = {{0.5, 0.7, 0.5}},
                                      .thrust = {.max_n = 650},
                                      .attitude_control = kNoThrusters,
                                      .control_period_s = control_period_s,
                                      .duration_s = 0.8};
  const DynamicsTrajectory trajectory(parameters);
  const RigidBodyMotion motion(parameters.body);
  Eigen::Vector2d worst = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k + 1 < trajectory.states().size(); ++k) {
    const RigidBodyState& from = trajectory.states()[k];
    const Load load{{{0, 0, -1.315}}, thrust_of(parameters.thrust, 1.315, 500, from), {}};
    for (const double u : {0.2, 0.5, 0.7}) {
      const RigidBodyState truth = motion.after(u * control_period_s, from, load);
      const Pose pose = trajectory.pose((static_cast<double>(k) + u) * control_period_s);
      const Eigen::Quaterniond attitude(pose.rotation.m);
      worst = worst.cwiseMax(Eigen::Vector2d((pose.position.v - truth.position_m.v).norm(),
                                             rotation_vector(attitude.conjugate() * truth.attitude).norm()));
    }
  }
  return worst;
}

TEST(Dynamics, InterpolationErrorIsWithinItsBoundAndOfFourthOrder) {
  const Eigen::Vector2d fine = interpolation_error(0.01);
  EXPECT_LT(fine.maxCoeff(), 1e-10);
  const Eigen::Vector2d coarse = interpolation_error(0.1);
  const Eigen::Vector2d coarser = interpolation_error(0.2);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(coarser[i] / coarse[i], 16, 4) << i;
}

// Held over a control period h the rate error shrinks by 1 - k h each time: v_n = v_c + (v_0 - v_c)(1 - k
// h)^n.
TEST(Dynamics, EngineHoldsTheDescentRate) {
  const DynamicsTrajectory descent({.velocity_mps = {{2, 0, -24}},
                                    .thrust = {.descent_rate_mps = 23, .gain_per_s = 2, .max_n = 5000},
                                    .control_period_s = 0.05,
                                    .duration_s = 5});
  for (std::size_t n = 0; n < descent.states().size(); ++n)
    EXPECT_NEAR(descent.states()[n].velocity_mps.v.z(), -23 - std::pow(0.9, n), 1e-11) << n;
  EXPECT_EQ(descent.states().back().velocity_mps.v.x(), 2) << "velocity across is left alone";
  EXPECT_EQ(descent.nominal_pose(2).position.v, Eigen::Vector3d(4, 0, 454));
}

// The lander integrates the forces that it measures, from a biased start: p - p_est = a_p + a_v t (Eq. 6).
// Thrusters fire and torques disturb alike in both; the engine carries the weight without feedback, for a
// corrected one would take the estimate's own velocity out.
TEST(Dynamics, BiasedEstimateDriftsAsEquation6) {
  const Vector<DemFrame> a_p{{0.4, -0.3, 0.7}};
  const Vector<DemFrame> a_v{{0.3, 0.3, 0.7}};
  DynamicsParameters parameters{.rpy = {0.01, -0.02, 0.5},
                                .rate_radps = {{0.003, 0.002, -0.001}},
                                .thrust = {.gain_per_s = 0},
                                .disturbance = {{{0.5, -0.2, 0.1}}, {{2, 2, 2}}},
                                .duration_s = 60};
  const DynamicsTrajectory truth(parameters);
  parameters.position_m = parameters.position_m - a_p;
  parameters.velocity_mps = parameters.velocity_mps - a_v;
  const DynamicsTrajectory estimate(parameters);
  for (double t = 0; t <= 60; t += 0.0777) {
    const Vector<DemFrame> error = truth.pose(t).position - estimate.pose(t).position;
    ASSERT_LT((error.v - (a_p + t * a_v).v).norm(), 1e-9) << "at " << t;
    ASSERT_EQ(truth.pose(t).rotation.m, estimate.pose(t).rotation.m);
  }
  EXPECT_GT((truth.pose(60).position - truth.nominal_pose(60).position).norm(), 1) << "the forces mattered";
}

/// One axis with thrusters, started at the rate of half a firing: torque 40 Nm for 10 ms on 100 kg m^2.
struct OneAxis {
  static constexpr double kFiring_radps = 40 * 0.01 / 100;
  static constexpr double kDeadband_rad = 1e-3;
  static constexpr double kRateGain_s = 0.1;
  static DynamicsParameters parameters(double duration_s) {
    return {.body = {.inertia_kgm2 = 100 * Eigen::Matrix3d::Identity()},
            .rate_radps = {{kFiring_radps / 2, 0, 0}},
            .attitude_control = {.deadband_rad = kDeadband_rad,
                                 .rate_gain_s = kRateGain_s,
                                 .torque_nm = Eigen::Vector3d::Constant(40)},
            .duration_s = duration_s};
  }
};

// Coasting at +-d/2 the switching function leaves the deadband at the angle W/2 = deadband - gain d/2. The
// firing begins at the control time after that, up to d h/2 further, and ends at the angle where it began. A
// period is two such ways across and two firings.
TEST(Dynamics, LimitCycleHasThePeriodAndAmplitudeOfItsClosedForm) {
  const double d = OneAxis::kFiring_radps;
  const double h = 0.01;
  const double width = 2 * (OneAxis::kDeadband_rad - OneAxis::kRateGain_s * d / 2);
  const DynamicsTrajectory cycle(OneAxis::parameters(20));
  std::vector<double> firings_s;
  for (std::size_t k = 1; k < cycle.states().size(); ++k) {
    const RigidBodyState& before = cycle.states()[k - 1];
    EXPECT_NEAR(std::abs(before.rate_radps.v.x()), d / 2, 1e-15) << k;
    if (before.rate_radps.v.x() * cycle.states()[k].rate_radps.v.x() > 0) continue;
    firings_s.push_back(h * static_cast<double>(k));
    const double extreme = std::abs(rotation_vector(before.attitude).x());
    EXPECT_GE(extreme, width / 2 - 1e-15);
    EXPECT_LE(extreme, width / 2 + d * h / 2 + 1e-15);
  }
  ASSERT_GT(firings_s.size(), 20U);
  for (std::size_t i = 2; i < firings_s.size(); ++i) {
    const double period = firings_s[i] - firings_s[i - 2];
    EXPECT_GE(period, 4 * width / d + 2 * h - 1e-12) << i;
    EXPECT_LE(period, 4 * width / d + 6 * h + 1e-12) << i;
  }
}

// A firing of 10 ms from +d/2 to -d/2 peaks in its middle, d h / 8 above its ends.
TEST(Dynamics, LimitCyclePeaksWithinTheFiring) {
  const DynamicsTrajectory cycle(OneAxis::parameters(1));
  std::size_t k = 0;
  while (cycle.states()[k + 1].rate_radps.v.x() > 0) ++k;
  const double h = 0.01;
  const double start = static_cast<double>(k) * h;
  const double above = turn(cycle.pose(start + h / 2)).x() - turn(cycle.pose(start)).x();
  EXPECT_NEAR(above, OneAxis::kFiring_radps * h / 8, 1e-15);
  EXPECT_NEAR(turn(cycle.pose(start + h)).x(), turn(cycle.pose(start)).x(), 1e-15);
}

TEST(Dynamics, ThrustersCatchADisturbedLander) {
  const DynamicsTrajectory held({.rpy = {0.02, -0.01, 0.03},
                                 .rate_radps = {{0.01, 0.01, -0.01}},
                                 .attitude_control = {.command = {0, 0, 0.02}},
                                 .disturbance = {{{1, 1, 1}}, {{1, 1, 1}}},
                                 .duration_s = 60});
  for (double t = 40; t <= 60; t += 0.1) {
    const Eigen::Matrix3d error = held.nominal_pose(t).rotation.m.transpose() * held.pose(t).rotation.m;
    EXPECT_LT(rotation_vector(Eigen::Quaterniond(error)).cwiseAbs().maxCoeff(), 1.3e-3) << t;
  }
}

// The rate after n periods is a sum of n draws of h sigma / I. Chi-square over 3 x 4000 draws: 4.5 sigma.
TEST(Dynamics, RandomTorqueHasItsSigma) {
  DynamicsParameters parameters{.body = {.inertia_kgm2 = 100 * Eigen::Matrix3d::Identity()},
                                .attitude_control = kNoThrusters,
                                .disturbance = {{}, {{0.1, 0.1, 0.1}}},
                                .duration_s = 40};
  const auto gains = [&] {
    const DynamicsTrajectory trajectory(parameters);
    std::vector<Eigen::Vector3d> result;
    for (std::size_t k = 1; k < trajectory.states().size(); ++k)
      result.push_back(trajectory.states()[k].rate_radps.v - trajectory.states()[k - 1].rate_radps.v);
    return result;
  };
  const std::vector<Eigen::Vector3d> first = gains();
  double sum = 0;
  for (const Eigen::Vector3d& gain : first) sum += (gain / (0.01 * 0.1 / 100)).squaredNorm();
  EXPECT_NEAR(sum / 12000, 1, 4.5 * std::sqrt(2.0 / 12000));
  // The same seed draws the same, whatever else acts; another seed draws others.
  parameters.disturbance.torque_sigma_nm.v.y() = 0;
  EXPECT_NEAR(gains()[100].x(), first[100].x(), 1e-15);
  EXPECT_NEAR(gains()[100].y(), 0, 1e-15);
  parameters.disturbance.seed = 2;
  EXPECT_GT(std::abs(gains()[100].x() - first[100].x()), 1e-9);
}

TEST(Dynamics, ConstantTorqueIsExact) {
  const DynamicsTrajectory turning(
      {.attitude_control = kNoThrusters, .disturbance = {{{0, 0, 8}}, {}}, .duration_s = 5});
  for (const double t : {0.004, 1.7777, 5.0})
    EXPECT_LT((turn(turning.pose(t)) - Eigen::Vector3d(0, 0, 0.5 * 8 / 400 * t * t)).norm(), 1e-13) << t;
}

TEST(Dynamics, RefusesBadNumbers) {
  EXPECT_THAT(dynamics_message({.gravity_mps2 = -1}), HasSubstr("gravity_mps2: -1"));
  EXPECT_THAT(dynamics_message({.control_period_s = 0}), HasSubstr("control_period_s: 0"));
  EXPECT_THAT(dynamics_message({.control_period_s = 1e-9}), HasSubstr("2000000 control periods"));
  EXPECT_THAT(dynamics_message({.duration_s = HUGE_VAL}), HasSubstr("duration_s: inf"));
  EXPECT_THAT(dynamics_message({.position_m = {{0, 0, std::nan("")}}}), HasSubstr("position_m/2: nan"));
  EXPECT_THAT(dynamics_message({.velocity_mps = {{HUGE_VAL, 0, 0}}}), HasSubstr("velocity_mps/0: inf"));
  EXPECT_THAT(dynamics_message({.rpy = {0, std::nan(""), 0}}), HasSubstr("rpy_deg/1: nan"));
  EXPECT_THAT(dynamics_message({.disturbance = {{}, {{0, -1, 0}}}}), HasSubstr("torque_sigma_nm/1: -1"));
  EXPECT_THAT(dynamics_message({.disturbance = {{{0, std::nan(""), 0}}, {}}}), HasSubstr("torque_nm/1: nan"));
  EXPECT_THAT(dynamics_message({.rate_radps = {{0, 0, 120}}}), HasSubstr("more than 1 rad"));
  EXPECT_THAT(dynamics_message({.rate_radps = {{0, 0, std::nan("")}}}), HasSubstr("rate_degps/2: nan"));
  EXPECT_THAT(dynamics_message({.body = {.mass_kg = -1}}), HasSubstr("mass_kg: -1"));
}

}  // namespace
}  // namespace landfall
