// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/trajectories.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
