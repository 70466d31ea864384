// SPDX-License-Identifier: GPL-3.0-or-later
// A product and a sum round twice on every processor, also in Eigen's own SIMD code.
#include <gtest/gtest.h>

#include <Eigen/Core>

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
