// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/quantile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <vector>

namespace landfall {
namespace {

double quantile_of(std::vector<double> values, double q) { return quantile_in_place(values, q); }

TEST(Quantile, SmallSetsByHand) {
  EXPECT_EQ(quantile_of({7}, 0.95), 7);
  EXPECT_EQ(quantile_of({3, 1}, 0.5), 2);          // h = 0.5
  EXPECT_EQ(quantile_of({4, 1, 3, 2}, 0.5), 2.5);  // h = 1.5
  EXPECT_EQ(quantile_of({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(quantile_of({8, 0, 4}, 0.75), 6);  // h = 1.5, between 4 and 8
  // 21 values 0, 1, .., 20: h = 20 * 0.95 = 19.
  EXPECT_EQ(quantile_of({20, 19, 18, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0}, 0.95),
            19);
}

TEST(Quantile, EndsAreMinimumAndMaximum) {
  EXPECT_EQ(quantile_of({3, 1, 2}, 0), 1);
  EXPECT_EQ(quantile_of({3, 1, 2}, 1), 3);
}

TEST(Quantile, Ties) {
  EXPECT_EQ(quantile_of({2, 2, 2, 2}, 0.95), 2);
  EXPECT_EQ(quantile_of({1, 2, 2, 1}, 0.5), 1.5);
}

TEST(Quantile, NoValueIsNan) { EXPECT_TRUE(std::isnan(quantile_of({}, 0.95))); }

// 35 x 35 bins: h = 1224 * 0.95 = 1162.8.
TEST(QuantileRank, OfAFullFootprint) {
  const QuantileRank rank = quantile_rank(1225, 0.95);
  EXPECT_EQ(rank.below, 1162U);
  EXPECT_NEAR(rank.frac, 0.8, 1e-12);
}

}  // namespace
}  // namespace landfall
