// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/geometry/rotation.h"

#include <gtest/gtest.h>

#include "constants.h"

namespace landfall {
namespace {

TEST(RotationMatrix, NominalMountIsExact) {
  EXPECT_EQ(rotation_matrix({kPi, 0, 0}), Eigen::Matrix3d(Eigen::Vector3d(1, -1, -1).asDiagonal()));
}

// Yaw turns x to y, pitch turns z to x, roll turns y to z.
TEST(RotationMatrix, QuarterTurns) {
  EXPECT_EQ(rotation_matrix({0, 0, kPi / 2}) * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  EXPECT_EQ(rotation_matrix({0, kPi / 2, 0}) * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
  EXPECT_EQ(rotation_matrix({kPi / 2, 0, 0}) * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(rotation_matrix({0, 0, -kPi / 2}) * Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY());
}

TEST(RotationMatrix, IsExactOverTwoTurnsEitherWay) {
  const Eigen::Vector3d turned[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (int quarters = -8; quarters <= 8; ++quarters)
    EXPECT_EQ(rotation_matrix({0, 0, quarters * (kPi / 2)}) * Eigen::Vector3d::UnitX(),
              turned[(quarters + 8) % 4])
        << quarters;
}

TEST(RollPitchYaw, IsZeroByDefaultAndLinearAngleByAngle) {
  EXPECT_EQ(RollPitchYaw{}, (RollPitchYaw{0, 0, 0}));
  EXPECT_EQ(linear({1, 2, 3}, 10, {4, -5, 6}), (RollPitchYaw{41, -48, 63}));
}

TEST(RotationMatrix, IsYawPitchRollInThatOrder) {
  const RollPitchYaw rpy{0.3, -0.2, 1.1};
  const Eigen::Matrix3d expected =
      (Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((rotation_matrix(rpy) - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Transform, InverseUndoes) {
  const Transform<DemFrame, BodyFrame> T{rotation_from<DemFrame, BodyFrame>({0.1, 0.2, 0.3}), {{1, 2, 3}}};
  const Point<BodyFrame> p{{-4, 5, 6}};
  EXPECT_LT((T.inverse() * (T * p) - p).norm(), 1e-14);
}

TEST(Transform, ChainsLikeItsParts) {
  const Transform<DemFrame, BodyFrame> T{rotation_from<DemFrame, BodyFrame>({0.1, 0.2, 0.3}), {{1, 2, 3}}};
  const Transform<BodyFrame, LidarFrame> S{rotation_from<BodyFrame, LidarFrame>({kPi, 0, 0.5}), {{0, 1, -2}}};
  const Point<LidarFrame> p{{7, 8, 9}};
  EXPECT_LT(((T * S) * p - T * (S * p)).norm(), 1e-14);
}

}  // namespace
}  // namespace landfall
