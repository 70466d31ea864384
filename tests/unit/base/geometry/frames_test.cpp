// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/geometry/frames.h"

#include <gtest/gtest.h>

#include <cmath>

namespace landfall {
namespace {

using DemVector = Vector<DemFrame>;
using DemPoint = Point<DemFrame>;
using DemDirection = Direction<DemFrame>;

/// A quarter turn about z: x of the body is y of the DEM.
const Rotation<DemFrame, BodyFrame> kQuarter{(Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished()};

TEST(Frames, DefaultsAreZeroUpAndNoTurn) {
  EXPECT_EQ(DemVector{}.v, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(DemPoint{}.v, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(DemDirection{}.v, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ((Rotation<DemFrame, BodyFrame>{}.m), Eigen::Matrix3d::Identity());
}

TEST(Frames, VectorsAddComponentByComponent) {
  const DemVector a{{1, 2, 3}};
  const DemVector b{{10, -20, 50}};
  EXPECT_EQ((a + b).v, Eigen::Vector3d(11, -18, 53));
  EXPECT_EQ((a - b).v, Eigen::Vector3d(-9, 22, -47));
  EXPECT_EQ((-a).v, Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ((4.0 * a).v, Eigen::Vector3d(4, 8, 12));
  EXPECT_EQ((DemVector{{2, -3, 6}}.norm()), 7);
}

TEST(Frames, ADirectionHasLengthOneAndZeroHasNone) {
  EXPECT_EQ((DemDirection::of({{0, 0, -8}}).v), Eigen::Vector3d(0, 0, -1));
  EXPECT_LT((DemDirection::of({{2, -3, 6}}).v - Eigen::Vector3d(2, -3, 6) / 7).norm(), 1e-16);
  EXPECT_TRUE(std::isnan(DemDirection::of({}).v.x()));
  EXPECT_EQ((3.0 * DemDirection{{0, -1, 0}}).v, Eigen::Vector3d(0, -3, 0));
}

TEST(Frames, PointsMoveByVectorsAndDifferByThem) {
  const DemPoint p{{1, 2, 3}};
  const DemVector a{{10, -20, 50}};
  EXPECT_EQ((p + a).v, Eigen::Vector3d(11, -18, 53));
  EXPECT_EQ((p - a).v, Eigen::Vector3d(-9, 22, -47));
  EXPECT_EQ((p - DemPoint{{5, 5, 5}}).v, Eigen::Vector3d(-4, -3, -2));
}

TEST(Frames, ARotationTurnsVectorsAndDirections) {
  EXPECT_EQ((kQuarter * Vector<BodyFrame>{{1, 2, 3}}).v, Eigen::Vector3d(-2, 1, 3));
  EXPECT_EQ((kQuarter * Direction<BodyFrame>{{1, 0, 0}}).v, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ((kQuarter.inverse() * DemVector{{1, 2, 3}}).v, Eigen::Vector3d(2, -1, 3));
}

// Half a turn about x first, then the quarter about z.
TEST(Frames, TheRightFactorTurnsFirst) {
  const Rotation<BodyFrame, LidarFrame> half{Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()};
  EXPECT_EQ((kQuarter * half * Vector<LidarFrame>{{1, 2, 3}}).v, Eigen::Vector3d(2, 1, -3));
}

TEST(Frames, ATransformTurnsAndThenMoves) {
  const Transform<DemFrame, BodyFrame> T{kQuarter, {{10, 20, 30}}};
  EXPECT_EQ((T * Point<BodyFrame>{{1, 2, 3}}).v, Eigen::Vector3d(8, 21, 33));
  EXPECT_EQ(T.inverse().position.v, Eigen::Vector3d(-20, 10, -30));
  EXPECT_EQ(T.inverse().rotation.m, kQuarter.m.transpose());
  const Transform<BodyFrame, LidarFrame> S{{Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()},
                                           {{1, 2, 3}}};
  EXPECT_EQ((T * S).position.v, Eigen::Vector3d(8, 21, 33));
  EXPECT_EQ(((T * S) * Point<LidarFrame>{{1, 2, 3}}).v, Eigen::Vector3d(10, 22, 30));
}

}  // namespace
}  // namespace landfall
