// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/trajectories.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
