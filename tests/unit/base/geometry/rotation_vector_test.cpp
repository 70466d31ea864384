// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/geometry/rotation_vector.h"
#include "test_seed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
