// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/table_trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "base/core/error.h"
#include "base/geometry/rotation.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Columns = std::map<std::string, std::vector<double>>;

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
              testing::HasSubstr("a.csv: has no attitude: add the columns qw,qx,qy,qz, or roll_deg"));
  EXPECT_THAT(columns_message({{"qw", {1, 1}}, {"qx", {0, 0}}, {"qy", {0, 0}}}),
              testing::HasSubstr("a.csv: no column qz, but has others of qw,qx,qy,qz"));
  Columns twice = kRollPitchYaw;
  for (const char* const name : {"mrp_1", "mrp_2", "mrp_3"}) twice[name] = {0, 0};
  EXPECT_THAT(columns_message(twice), testing::HasSubstr("has two attitudes"));
  Columns half = kRollPitchYaw;
  half["vx_mps"] = {0, 0};
  EXPECT_THAT(columns_message(half),
              testing::HasSubstr("no column vy_mps, but has others of vx_mps,vy_mps,vz_mps"));
}

}  // namespace
}  // namespace landfall
