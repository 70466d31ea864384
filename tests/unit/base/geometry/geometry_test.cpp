// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

#include "base/geometry/frames.h"
#include "base/geometry/rotation.h"
#include "base/geometry/rotation_vector.h"
#include "base/geometry/vector_check.h"
#include "constants.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

using DemDirection = Direction<DemFrame>;
using DemPoint = Point<DemFrame>;
using DemVector = Vector<DemFrame>;

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

TEST(RotationVector, TurnsAboutItsOwnAxis) {
  const Eigen::Quaterniond q = quaternion_of({0, 0, 0.6});
  EXPECT_DOUBLE_EQ(q.w(), std::cos(0.3));
  EXPECT_DOUBLE_EQ(q.z(), std::sin(0.3));
  EXPECT_LT((q * Eigen::Vector3d::UnitX() - Eigen::Vector3d(std::cos(0.6), std::sin(0.6), 0)).norm(), 1e-15);
}

TEST(RotationVector, ZeroAndTheSmallestAngles) {
  EXPECT_EQ(quaternion_of(Eigen::Vector3d::Zero()).coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_EQ(rotation_vector(Eigen::Quaterniond::Identity()), Eigen::Vector3d::Zero());
  const Eigen::Vector3d tiny(1e-12, -2e-12, 3e-12);
  EXPECT_LT((rotation_vector(quaternion_of(tiny)) - tiny).norm(), 1e-27);
}

TEST(RotationVector, BothSignsOfAQuaternionAreOneRotation) {
  Eigen::Quaterniond q = quaternion_of({0.1, -2, 0.7});
  const Eigen::Vector3d phi = rotation_vector(q);
  q.coeffs() *= -1;
  EXPECT_EQ(rotation_vector(q), phi);
}

class RandomRotation : public testing::Test {
 protected:
  /// A vector of length below `length`.
  Eigen::Vector3d vector(double length) {
    std::uniform_real_distribution<double> unit(-1, 1);
    Eigen::Vector3d v(unit(random_), unit(random_), unit(random_));
    return std::abs(unit(random_)) * length * v.normalized();
  }

 private:
  std::mt19937_64 random_{test_seed()};
};

TEST_F(RandomRotation, RoundTrip) {
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d phi = vector(3.1);
    EXPECT_LT((rotation_vector(quaternion_of(phi)) - phi).norm(), 1e-13) << phi.transpose();
    const Eigen::Matrix3d R = Eigen::AngleAxisd(phi.norm(), phi.normalized()).toRotationMatrix();
    EXPECT_LT((quaternion_of(phi).toRotationMatrix() - R).norm(), 1e-14);
  }
}

// The rate against a central difference of log(exp(phi) exp(omega t)).
TEST_F(RandomRotation, RateIsTheDerivative) {
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d phi = vector(2.5);
    const Eigen::Vector3d omega = vector(1);
    const auto at = [&](double t) { return rotation_vector(quaternion_of(phi) * quaternion_of(t * omega)); };
    const Eigen::Vector3d difference = (at(kStep) - at(-kStep)) / (2 * kStep);
    EXPECT_LT((rotation_vector_rate(phi, omega) - difference).norm(), 1e-7) << phi.transpose();
  }
}

TEST(RotationVector, WithoutATurnTheRateIsTheAngularRate) {
  const Eigen::Vector3d omega(0.1, -0.2, 0.3);
  EXPECT_EQ(rotation_vector_rate(Eigen::Vector3d::Zero(), omega), omega);
}

// At 0.02 rad the series takes over: both ways must agree there.
TEST_F(RandomRotation, TheSeriesMeetsTheClosedForm) {
  const Eigen::Vector3d omega(0, 1, 0);
  const auto c = [&](double a) { return -rotation_vector_rate({a, 0, 0}, omega).y() + 1; };
  EXPECT_NEAR(c(0.02 * (1 - 1e-12)), c(0.02 * (1 + 1e-12)), 5e-15);
}

// A product and a sum round twice on every processor, also in Eigen's own SIMD code.
constexpr double kBelow = 1 - 0x1p-30;
constexpr double kAbove = 1 + 0x1p-30;  // kBelow * kAbove = 1 - 2^-60, which rounds to 1

template <class Matrix>
void expect_two_roundings() {
  Matrix a = Matrix::Zero();
  Matrix b = Matrix::Zero();
  a.col(0).setConstant(-1);
  b.row(0).setConstant(1);
  a.col(1).setConstant(kBelow);
  b.row(1).setConstant(kAbove);
  const Matrix product = a * b;
  for (Eigen::Index i = 0; i < product.size(); ++i) EXPECT_EQ(product.data()[i], 0) << i;
}

TEST(TwoRoundings, ProductsOfMatrices) {
  expect_two_roundings<Eigen::Matrix2d>();
  expect_two_roundings<Eigen::Matrix3d>();
  expect_two_roundings<Eigen::Matrix4d>();
}

TEST(TwoRoundings, ProductsOfVectors) {
  const Eigen::Vector4d a(-1, -1, kBelow, kBelow);
  const Eigen::Vector4d b(1, 1, kAbove, kAbove);
  EXPECT_EQ(a.dot(b), 0);
}

TEST(GeometryCheck, DegreesAreRoundedForPeople) {
  EXPECT_EQ(in_degrees(std::numbers::pi / 6), 30);
  EXPECT_EQ(in_degrees(-std::numbers::pi), -180);
  EXPECT_EQ(in_degrees(1e-9 * std::numbers::pi / 180), 1e-9);
  EXPECT_EQ(in_degrees(1e-10 * std::numbers::pi / 180), 0);
}

TEST(GeometryCheck, AnAngleIsNamedInDegrees) {
  const auto check = [](bool holds) {
    require_angle(holds, {"scanner", "tilt_deg"}, std::numbers::pi / 2, "below 45");
  };
  EXPECT_EQ(refusal([&] { check(true); }), "accepted");
  EXPECT_THAT(refusal([&] { check(false); }), testing::HasSubstr("scanner/tilt_deg: 90 is not below 45"));
}

TEST(GeometryCheck, TheComponentThatIsNotFiniteIsNamed) {
  const auto of_vector = [](const Eigen::Vector3d& v) { require_finite({"lander", "v"}, v); };
  EXPECT_EQ(refusal([&] { of_vector({1, 2, 3}); }), "accepted");
  EXPECT_THAT(refusal([&] { of_vector({NAN, 2, 3}); }), testing::HasSubstr("lander/v/0"));
  EXPECT_THAT(refusal([&] { of_vector({1, 2, HUGE_VAL}); }), testing::HasSubstr("lander/v/2"));
  const struct {
    Eigen::Vector3d v{1, 2, 3};
    double after = NAN;
  } larger;
  EXPECT_EQ(refusal([&] { of_vector(larger.v); }), "accepted");
  const auto of_angles = [](const RollPitchYaw& rpy) { require_finite({"lander", "rpy"}, rpy); };
  EXPECT_EQ(refusal([&] { of_angles({1, 2, 3}); }), "accepted");
  EXPECT_THAT(refusal([&] { of_angles({1, NAN, 3}); }), testing::HasSubstr("lander/rpy/1"));
}

}  // namespace
}  // namespace landfall
