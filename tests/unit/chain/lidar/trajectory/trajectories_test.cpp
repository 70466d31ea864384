// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "base/core/error.h"
#include "base/geometry/rotation.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Columns = std::map<std::string, std::vector<double>>;
using Motion = std::function<Eigen::Vector3d(double)>;
using testing::HasSubstr;

TEST(ConstantVelocity, DefaultIsThePapersDescent) {
  const ConstantVelocity descent({});
  EXPECT_EQ(descent.epoch_s(), 0);
  EXPECT_TRUE(std::isinf(descent.end_time_s()));
  EXPECT_EQ(descent.pose(0).position.v, Eigen::Vector3d(0, 0, 500));
  EXPECT_EQ(descent.pose(2).position.v, Eigen::Vector3d(0, 0, 454));
  EXPECT_EQ(descent.pose(2).rotation.m, Eigen::Matrix3d::Identity());
}

TEST(ConstantVelocity, AnglesAreLinear) {
  const ConstantVelocity turning({.position_m = {{1, 2, 3}},
                                  .velocity_mps = {{4, 5, 6}},
                                  .rpy = {0.1, 0.2, 0.3},
                                  .rpy_rate_radps = {0.01, -0.02, 0.04}});
  const Pose pose = turning.pose(5);
  EXPECT_EQ(pose.position.v, Eigen::Vector3d(21, 27, 33));
  EXPECT_LT((pose.rotation.m - rotation_matrix({0.15, 0.1, 0.5})).norm(), 1e-15);
}

TEST(ConstantVelocity, RefusesWhatIsNotFinite) {
  const double nan = std::nan("");
  EXPECT_THROW(ConstantVelocity({.position_m = {{nan, 0, 0}}}), UsageError);
  EXPECT_THROW(ConstantVelocity({.velocity_mps = {{0, nan, 0}}}), UsageError);
  EXPECT_THROW(ConstantVelocity({.rpy = {0, 0, nan}}), UsageError);
  EXPECT_THROW(ConstantVelocity({.rpy_rate_radps = {0, HUGE_VAL, 0}}), UsageError);
}

DispersedTrajectory dispersed(const DispersionParameters& departure,
                              const ConstantVelocityParameters& path = {}) {
  return {std::make_unique<ConstantVelocity>(path), departure};
}

TEST(DispersedTrajectory, DepartsLinearlyFromThePath) {
  const DispersedTrajectory true_path =
      dispersed({.position_m = {{1, 2, 3}}, .velocity_mps = {{0.5, -0.25, 1}}});
  EXPECT_EQ(true_path.pose(0).position.v, Eigen::Vector3d(1, 2, 503));
  EXPECT_EQ(true_path.pose(2).position.v, Eigen::Vector3d(2, 1.5, 459));
  EXPECT_EQ(true_path.nominal_pose(2).position.v, Eigen::Vector3d(0, 0, 454));
  EXPECT_EQ(true_path.epoch_s(), 0);
  EXPECT_TRUE(std::isinf(true_path.end_time_s()));
  EXPECT_TRUE(std::isinf(true_path.earliest_time_s()));
}

// The departure turns the body about its own axes, so it follows the attitude of the path.
TEST(DispersedTrajectory, TurnsTheBodyAboutItsOwnAxes) {
  const DispersedTrajectory true_path = dispersed({.rpy = {0.1, 0, 0}, .rpy_rate_radps = {0, 0.2, 0.05}},
                                                  {.rpy = {0, 0, 1.5}, .rpy_rate_radps = {0, 0, 0.1}});
  const Eigen::Matrix3d expected = rotation_matrix({0, 0, 1.7}) * rotation_matrix({0.1, 0.4, 0.1});
  EXPECT_LT((true_path.pose(2).rotation.m - expected).norm(), 1e-15);
  EXPECT_LT((true_path.nominal_pose(2).rotation.m - rotation_matrix({0, 0, 1.7})).norm(), 1e-15);
}

TEST(DispersedTrajectory, RefusesWhatIsNotFinite) {
  const double nan = std::nan("");
  EXPECT_THROW(dispersed({.position_m = {{nan, 0, 0}}}), UsageError);
  EXPECT_THROW(dispersed({.velocity_mps = {{0, HUGE_VAL, 0}}}), UsageError);
  EXPECT_THROW(dispersed({.rpy = {0, 0, nan}}), UsageError);
  EXPECT_THROW(dispersed({.rpy_rate_radps = {0, nan, 0}}), UsageError);
}

TableTrajectory sampled(const Motion& motion, std::initializer_list<double> times) {
  std::vector<TrajectorySample> samples;
  for (const double t : times) samples.push_back({t, {motion(t)}, Eigen::Quaterniond::Identity()});
  return TableTrajectory(std::move(samples));
}

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

std::string samples_message(std::vector<TrajectorySample> samples) {
  return refusal<FormatError>([&] { const TableTrajectory table(std::move(samples)); });
}

TEST(TableTrajectory, StartsAtItsFirstRow) {
  const TableTrajectory table = sampled([](double) { return Eigen::Vector3d::Zero(); }, {7, 8, 10});
  EXPECT_EQ(table.epoch_s(), 7);
  EXPECT_EQ(table.earliest_time_s(), 0);
  EXPECT_EQ(table.end_time_s(), 3);
}

TEST(TableTrajectory, TwoRowsAreAStraightLine) {
  const TableTrajectory table =
      sampled([](double t) { return Eigen::Vector3d(t, -2 * t, 500 - 23 * t); }, {0, 2});
  EXPECT_LT((table.pose(0.3).position.v - Eigen::Vector3d(0.3, -0.6, 493.1)).norm(), 1e-12);
}

// p = (t^2, 3 - t, 500 - 23 t + 0.6575 t^2) on uneven times: exact everywhere, the ends included.
TEST(TableTrajectory, QuadraticMotionIsExact) {
  const Motion motion = [](double t) { return Eigen::Vector3d(t * t, 3 - t, 500 - 23 * t + 0.6575 * t * t); };
  const TableTrajectory table = sampled(motion, {0, 0.1, 0.5, 0.6, 1.7, 2});
  for (double t = 0; t <= 2; t += 0.01)
    EXPECT_LT((table.pose(t).position.v - motion(t)).norm(), 3e-13) << "at " << t;
}

TEST(TableTrajectory, GoesThroughItsSamples) {
  const Motion motion = [](double t) { return Eigen::Vector3d(std::sin(9 * t), std::exp(t), -t * t * t); };
  const auto times = {0.0, 0.3, 0.35, 1.0};
  const TableTrajectory table = sampled(motion, times);
  for (const double t : times) EXPECT_EQ(table.pose(t).position.v, motion(t));
}

// The parabola through three samples of t^3 at -1, 0, 1 is the line t: slope 1 at each of them, so both
// pieces are that line. Slopes of the cubic itself (3, 0, 3) would give t^3.
TEST(TableTrajectory, SlopesComeFromThreePoints) {
  const TableTrajectory table =
      sampled([](double t) { return Eigen::Vector3d(t * t * t, 0, 0); }, {-1, 0, 1});
  EXPECT_NEAR(table.pose(1.25).position.v.x(), 0.25, 1e-15);
  EXPECT_NEAR(table.pose(0.25).position.v.x(), -0.75, 1e-15);
}

// With its velocities a cubic is itself; a sample without one takes its parabola's.
TEST(TableTrajectory, SlopesAreTheVelocitiesWhereGiven) {
  const auto cubic = [](double t) {
    return TrajectorySample{
        .t_s = t, .position_m = {{t * t * t, -t, 500}}, .velocity_mps = Vector<DemFrame>{{3 * t * t, -1, 0}}};
  };
  std::vector<TrajectorySample> samples = {cubic(-1), cubic(0.5), cubic(1)};
  const TableTrajectory table(samples);
  for (const double t : {-0.9, -0.1, 0.7})
    EXPECT_LT((table.pose(t + 1).position.v - cubic(t).position_m.v).norm(), 1e-13) << t;
  samples[1].velocity_mps.reset();
  EXPECT_GT((TableTrajectory(samples).pose(1.7).position.v - cubic(0.7).position_m.v).norm(), 1e-3);
}

TEST(TableTrajectory, AttitudeIsSlerp) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3;
  const TableTrajectory table({{0, {}, about(axis, 0.2)}, {2, {}, about(axis, 1.0)}});
  const Eigen::Matrix3d expected = Eigen::AngleAxisd(0.2 + 0.8 * 0.35, axis).toRotationMatrix();
  EXPECT_LT((table.pose(0.7).rotation.m - expected).norm(), 1e-15);
}

TEST(TableTrajectory, AttitudeGoesTheShortestWay) {
  Eigen::Quaterniond turned = about(Eigen::Vector3d::UnitZ(), 0.4);
  turned.coeffs() *= -1;  // the same attitude
  const TableTrajectory table({{0, {}, Eigen::Quaterniond::Identity()}, {1, {}, turned}});
  EXPECT_LT((table.pose(0.5).rotation.m - rotation_matrix({0, 0, 0.2})).norm(), 1e-15);
}

// Scalar first, D <- B: (cos 45 deg, 0, 0, sin 45 deg) yaws the body's x axis to y.
TEST(TableTrajectory, QuaternionTurnsBodyIntoDem) {
  const double h = std::numbers::sqrt2 / 2;
  const Eigen::Quaterniond yaw(h, 0, 0, h);
  const TableTrajectory table({{0, {}, yaw}, {1, {}, yaw}});
  EXPECT_LT((table.pose(0.5).rotation.m * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

// The convention of rotation_matrix() for roll, pitch and yaw survives the way through a quaternion table.
TEST(TableTrajectory, RollPitchYawRoundTrip) {
  const Eigen::Matrix3d R = rotation_matrix({0.3, -1.2, 2.8});
  const TableTrajectory table({{0, {}, Eigen::Quaterniond(R)}, {1, {}, Eigen::Quaterniond(R)}});
  EXPECT_LT((table.pose(0.4).rotation.m - R).norm(), 1e-15);
}

TEST(TableTrajectory, NormalisesWhatIsNearlyAUnitQuaternion) {
  Eigen::Quaterniond q = about(Eigen::Vector3d::UnitX(), 0.5);
  q.coeffs() *= 1.0009;
  const TableTrajectory table({{0, {}, q}, {1, {}, q}});
  EXPECT_LT((table.pose(0).rotation.m - rotation_matrix({0.5, 0, 0})).norm(), 1e-15);
  q.coeffs() *= 1.0002;
  EXPECT_THAT(samples_message({{0, {}, Eigen::Quaterniond::Identity()}, {1, {}, q}}),
              HasSubstr("row 2: the quaternion's norm is 1.001"));
}

TEST(TableTrajectory, RefusesABadTable) {
  const Eigen::Quaterniond one = Eigen::Quaterniond::Identity();
  EXPECT_THAT(samples_message({}), HasSubstr("0 rows"));
  EXPECT_THAT(samples_message({{0, {}, one}}), HasSubstr("1 rows"));
  EXPECT_THAT(samples_message({{0, {}, one}, {1, {}, one}, {1, {}, one}}), HasSubstr("row 3: t_s"));
  EXPECT_THAT(samples_message({{0, {}, one}, {-1, {}, one}}), HasSubstr("row 2: t_s"));
  EXPECT_THAT(samples_message({{0, {}, one}, {std::nan(""), {}, one}}), HasSubstr("row 2: a value"));
  EXPECT_THAT(samples_message({{0, {{0, HUGE_VAL, 0}}, one}, {1, {}, one}}), HasSubstr("row 1: a value"));
  EXPECT_THAT(samples_message({{0, {}, one, Vector<DemFrame>{{0, 0, HUGE_VAL}}}, {1, {}, one}}),
              HasSubstr("row 1: a value"));
  EXPECT_THAT(samples_message({{0, {}, one}, {1, {}, Eigen::Quaterniond(1, 0, 0, std::nan(""))}}),
              HasSubstr("row 2: a value"));
}

TEST(TableTrajectory, RefusesTimesOutsideTheTable) {
  const TableTrajectory table = sampled([](double t) { return Eigen::Vector3d(t, 0, 0); }, {1, 2.5});
  EXPECT_EQ(table.pose(1.5 + 0.9e-9).position.v.x(), 2.5);
  EXPECT_EQ(table.pose(-0.9e-9).position.v.x(), 1);
  EXPECT_THROW(static_cast<void>(table.pose(-2e-9)), FormatError);
  EXPECT_THROW(static_cast<void>(table.pose(std::nan(""))), FormatError);
  EXPECT_THAT(refusal<FormatError>([&] { return table.pose(1.75); }),
              testing::EndsWith("1.75 s lies outside the table, 0 .. 1.5 s after its first row, t_s = 1"));
}

// 1.4e9 s, a GPS time, has a spacing of 2.4e-7 s; rows at multiples of 2^-20 s are exact in both tables.
TEST(TableTrajectory, IsTheSameOnAnyClock) {
  const Motion motion = [](double t) { return Eigen::Vector3d(std::sin(t), 30 * t, std::exp(-t)); };
  const auto on_clock = [&](double epoch_s) {
    std::vector<TrajectorySample> samples;
    for (const double t : {0.0, 0.25, 1 + 0x1p-20, 1.75, 3.0})
      samples.push_back({epoch_s + t, {motion(t)}, about({0, 0, 1}, t)});
    return TableTrajectory(std::move(samples));
  };
  const TableTrajectory table = on_clock(0);
  const TableTrajectory gps = on_clock(1.4e9);
  EXPECT_EQ(gps.epoch_s(), 1.4e9);
  EXPECT_EQ(gps.end_time_s(), table.end_time_s());
  for (double t = 0; t <= 3; t += 1.0 / 300) ASSERT_EQ(gps.pose(t), table.pose(t)) << t;
}

// At -1e9 s, rows 1e-10 s apart are the same time.
TEST(TableTrajectory, RefusesRowsThatTheirEpochDoesNotSeparate) {
  const Eigen::Quaterniond one = Eigen::Quaterniond::Identity();
  EXPECT_THAT(samples_message({{-1e9, {}, one}, {1e-10, {}, one}, {2e-10, {}, one}}),
              HasSubstr("row 3: t_s"));
}

NumberTable table_of(const Columns& attitude) {
  Columns columns = {{"t_s", {0, 1}}, {"x_m", {1, 4}}, {"y_m", {2, 5}}, {"z_m", {3, 6}}};
  columns.insert(attitude.begin(), attitude.end());
  return {"a.csv", std::move(columns)};
}

const Columns kRollPitchYaw = {{"roll_deg", {10, 0}}, {"pitch_deg", {20, 0}}, {"yaw_deg", {30, 90}}};

std::string columns_message(const Columns& columns) {
  return refusal<FormatError>([&] { return trajectory_samples(table_of(columns)); });
}

TEST(TrajectoryColumns, QuaternionIsScalarFirst) {
  const auto samples =
      trajectory_samples(table_of({{"qw", {1, 0.1}}, {"qx", {0, 0.2}}, {"qy", {0, 0.3}}, {"qz", {0, 0.4}}}));
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].t_s, 1);
  EXPECT_EQ(samples[1].position_m.v, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(samples[1].attitude.w(), 0.1);
  EXPECT_EQ(samples[1].attitude.vec(), Eigen::Vector3d(0.2, 0.3, 0.4));
  EXPECT_FALSE(samples[1].velocity_mps);
}

TEST(TrajectoryColumns, RollPitchYawIsThreeTwoOne) {
  const auto samples = trajectory_samples(table_of(kRollPitchYaw));
  const double deg = std::numbers::pi / 180;
  EXPECT_LT((samples[0].attitude.toRotationMatrix() - rotation_matrix({10 * deg, 20 * deg, 30 * deg})).norm(),
            1e-15);
  EXPECT_LT((samples[1].attitude * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(TrajectoryColumns, VelocityIsOptional) {
  Columns columns = kRollPitchYaw;
  columns["vx_mps"] = {7, 0};
  columns["vy_mps"] = {8, 0};
  columns["vz_mps"] = {9, 0};
  const auto samples = trajectory_samples(table_of(columns));
  ASSERT_TRUE(samples[0].velocity_mps);
  EXPECT_EQ(samples[0].velocity_mps->v, Eigen::Vector3d(7, 8, 9));
}

// A body yawed by +90 deg against N: sigma = tan(22.5 deg) z; its x axis points along y_N, and [BN] turns the
// components of that direction, (0, 1, 0) in N, into (1, 0, 0) in B.
TEST(TrajectoryColumns, RodriguesParametersTurnTheBody) {
  const auto samples = trajectory_samples(
      table_of({{"mrp_1", {0, 0}}, {"mrp_2", {0, 0}}, {"mrp_3", {std::tan(std::numbers::pi / 8), 1}}}));
  EXPECT_LT((samples[0].attitude * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((samples[1].attitude * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitX()).norm(), 1e-15);
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// [BN] of Modified Rodrigues Parameters (Schaub and Junkins 2018, Eq. 3.150).
Eigen::Matrix3d dcm_bn(const Eigen::Vector3d& sigma) {
  const double s = sigma.squaredNorm();
  const Eigen::Matrix3d tilde = cross_matrix(sigma);
  return Eigen::Matrix3d::Identity() + (8 * tilde * tilde - 4 * (1 - s) * tilde) / ((1 + s) * (1 + s));
}

// Random attitudes: R_dem_body = [BN]^T, and so of the shadow set; a table that changes from one set to the
// other turns no further than one that stays in one.
TEST(TrajectoryColumnsProperty, RodriguesParametersAndTheirShadowsAreBasilisks) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d sigma(unit(random), unit(random), unit(random));
    const Eigen::Vector3d next = sigma + 0.05 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    const Eigen::Vector3d shadow = -next / next.squaredNorm();
    const auto table = [&](const Eigen::Vector3d& second) {
      return TableTrajectory(trajectory_samples(table_of({{"mrp_1", {sigma.x(), second.x()}},
                                                          {"mrp_2", {sigma.y(), second.y()}},
                                                          {"mrp_3", {sigma.z(), second.z()}}})));
    };
    EXPECT_LT((table(next).pose(0).rotation.m - dcm_bn(sigma).transpose()).norm(), 1e-14);
    for (const double t : {0.3, 1.0})
      EXPECT_LT((table(next).pose(t).rotation.m - table(shadow).pose(t).rotation.m).norm(), 1e-14);
    EXPECT_LT((table(shadow).pose(1).rotation.m - dcm_bn(next).transpose()).norm(), 1e-14);
  }
}

TEST(TrajectoryColumns, RefusesAnAttitudeThatIsMissingIncompleteOrGivenTwice) {
  EXPECT_THAT(columns_message({}),
              HasSubstr("a.csv: has no attitude: add the columns qw,qx,qy,qz, or roll_deg"));
  EXPECT_THAT(columns_message({{"qw", {1, 1}}, {"qx", {0, 0}}, {"qy", {0, 0}}}),
              HasSubstr("a.csv: no column qz, but has others of qw,qx,qy,qz"));
  Columns twice = kRollPitchYaw;
  for (const char* const name : {"mrp_1", "mrp_2", "mrp_3"}) twice[name] = {0, 0};
  EXPECT_THAT(columns_message(twice), HasSubstr("has two attitudes"));
  Columns half = kRollPitchYaw;
  half["vx_mps"] = {0, 0};
  EXPECT_THAT(columns_message(half), HasSubstr("no column vy_mps, but has others of vx_mps,vy_mps,vz_mps"));
}

}  // namespace
}  // namespace landfall
