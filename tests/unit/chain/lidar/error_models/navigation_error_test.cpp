// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/error_models/navigation_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "constants.h"

namespace landfall {
namespace {

using Pose = Transform<DemFrame, BodyFrame>;

const Pose kTruth{rotation_from<DemFrame, BodyFrame>({0, 0, kPi / 2}), {{10, 20, 500}}};

TEST(LinearNavigationError, NoneIsTheTruth) {
  EXPECT_EQ(LinearNavigationError({}).estimated(kTruth, 1.5), kTruth);
}

// Eq. 4, position: the error is truth - estimate, so the estimate lies lower by it, in the DEM's axes.
TEST(LinearNavigationError, PositionErrorIsSubtracted) {
  const LinearNavigationError error({.position_m = {{1, -2, 3}}});
  const Pose estimate = error.estimated(kTruth, 0);
  EXPECT_EQ(estimate.position.v, Eigen::Vector3d(9, 22, 497));
  EXPECT_EQ(estimate.rotation, kTruth.rotation);
}

// Eq. 4, rotation: the truth yaws by 90 deg; a roll error of +90 deg comes first, in the body. It takes the
// body's y to z, where the truth leaves it: R_est e_y = R R_err e_y = R e_z = e_z. (Multiplied on the left it
// would be R_err R e_y = -e_x.)
TEST(LinearNavigationError, RotationErrorIsAppliedInTheBody) {
  const LinearNavigationError error({.rpy = {kPi / 2, 0, 0}});
  const Pose estimate = error.estimated(kTruth, 0);
  EXPECT_EQ(estimate.rotation.m * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(estimate.rotation.m * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  EXPECT_EQ(estimate.position, kTruth.position);
}

// Eq. 6 at t = 2: p_err = (1, 0, 0) + 2 (0.3, 0.3, 0.7), yaw error = 0.1 + 2 * 0.2.
TEST(LinearNavigationError, GrowsLinearly) {
  const LinearNavigationError error({.position_m = {{1, 0, 0}},
                                     .velocity_mps = {{0.3, 0.3, 0.7}},
                                     .rpy = {0, 0, 0.1},
                                     .rpy_rate_radps = {0, 0, 0.2}});
  const Pose estimate = error.estimated(kTruth, 2);
  EXPECT_LT((estimate.position.v - Eigen::Vector3d(8.4, 19.4, 498.6)).norm(), 1e-13);
  EXPECT_LT((estimate.rotation.m - rotation_matrix({0, 0, kPi / 2 + 0.5})).norm(), 1e-15);
}

TEST(LinearNavigationError, RefusesWhatIsNotFinite) {
  const double nan = std::nan("");
  EXPECT_THROW(LinearNavigationError({.position_m = {{nan, 0, 0}}}), UsageError);
  EXPECT_THROW(LinearNavigationError({.velocity_mps = {{0, HUGE_VAL, 0}}}), UsageError);
  EXPECT_THROW(LinearNavigationError({.rpy = {0, 0, nan}}), UsageError);
  EXPECT_THROW(LinearNavigationError({.rpy_rate_radps = {nan, 0, 0}}), UsageError);
}

}  // namespace
}  // namespace landfall
