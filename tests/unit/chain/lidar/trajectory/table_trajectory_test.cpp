// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/table_trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "base/core/error.h"
#include "base/geometry/rotation.h"
#include "refusal.h"

namespace landfall {
namespace {

using Motion = std::function<Eigen::Vector3d(double)>;

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
              testing::HasSubstr("row 2: the quaternion's norm is 1.001"));
}

TEST(TableTrajectory, RefusesABadTable) {
  const Eigen::Quaterniond one = Eigen::Quaterniond::Identity();
  EXPECT_THAT(samples_message({}), testing::HasSubstr("0 rows"));
  EXPECT_THAT(samples_message({{0, {}, one}}), testing::HasSubstr("1 rows"));
  EXPECT_THAT(samples_message({{0, {}, one}, {1, {}, one}, {1, {}, one}}), testing::HasSubstr("row 3: t_s"));
  EXPECT_THAT(samples_message({{0, {}, one}, {-1, {}, one}}), testing::HasSubstr("row 2: t_s"));
  EXPECT_THAT(samples_message({{0, {}, one}, {std::nan(""), {}, one}}), testing::HasSubstr("row 2: a value"));
  EXPECT_THAT(samples_message({{0, {{0, HUGE_VAL, 0}}, one}, {1, {}, one}}),
              testing::HasSubstr("row 1: a value"));
  EXPECT_THAT(samples_message({{0, {}, one, Vector<DemFrame>{{0, 0, HUGE_VAL}}}, {1, {}, one}}),
              testing::HasSubstr("row 1: a value"));
  EXPECT_THAT(samples_message({{0, {}, one}, {1, {}, Eigen::Quaterniond(1, 0, 0, std::nan(""))}}),
              testing::HasSubstr("row 2: a value"));
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
              testing::HasSubstr("row 3: t_s"));
}

}  // namespace
}  // namespace landfall
