// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/perspective.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "test_seed.h"

namespace landfall {
namespace {

TEST(RadialDistortion, FactorIsThePolynomial) {
  EXPECT_EQ((RadialDistortion{}.factor(0.7)), 1);
  EXPECT_EQ((RadialDistortion{2, 4, 8}.factor(0.5)), 1 + 1 + 1 + 1);
}

// r - r^3 / 3 turns at r = 1; r + k2 r^5 and r + k3 r^7 at (-5 k2)^(-1/4) and (-7 k3)^(-1/6).
TEST(FoldRadius, ClosedForms) {
  EXPECT_NEAR(fold_radius({-1.0 / 3, 0, 0}, 2).value(), 1, 1e-12);
  EXPECT_NEAR(fold_radius({0, -0.1, 0}, 2).value(), std::pow(0.5, -0.25), 1e-12);
  EXPECT_NEAR(fold_radius({0, 0, -3}, 2).value(), std::pow(21, -1.0 / 6), 1e-12);
  // 1 - 5 s / 2 + s^2 has the roots 1/2 and 2.
  EXPECT_NEAR(fold_radius({-2.5 / 3, 0.2, 0}, 10).value(), std::sqrt(0.5), 1e-12);
  // The image folds and unfolds before the end: a root that is not the last one.
  EXPECT_NEAR(fold_radius({-2.5 / 3, 0.2, 1e-9}, 10).value(), std::sqrt(0.5), 1e-8);
}

TEST(FoldRadius, NoneWithoutOrBelowTheFold) {
  EXPECT_FALSE(fold_radius({}, 100));
  EXPECT_FALSE(fold_radius({0.5, 0.1, 0.3}, 100));
  EXPECT_FALSE(fold_radius({-1.0 / 3, 0, 0}, 0.999999));
  EXPECT_TRUE(fold_radius({-1.0 / 3, 0, 0}, 1.000001));
  EXPECT_FALSE(fold_radius({-1.0 / 3, 0.3, 0}, 100));
}

// Against a walk along the radius.
TEST(FoldRadius, RandomCoefficients) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> k(-1, 1);
  int folded = 0;
  for (int round = 0; round < 300; ++round) {
    const RadialDistortion d{k(random), k(random), k(random)};
    constexpr double kStep = 1e-3;
    double walked = 0;
    const auto distorted = [&](double r) { return r * d.factor(r * r); };
    while (walked < 1.5 && distorted(walked + kStep) > distorted(walked)) walked += kStep;
    const auto fold = fold_radius(d, 1.5);
    EXPECT_EQ(fold.has_value(), walked < 1.5 - kStep) << d.k1 << ' ' << d.k2 << ' ' << d.k3;
    if (fold) {
      EXPECT_NEAR(*fold, walked, 2 * kStep);
      ++folded;
    }
  }
  EXPECT_GT(folded, 50);
  EXPECT_LT(folded, 250);
}

}  // namespace
}  // namespace landfall
