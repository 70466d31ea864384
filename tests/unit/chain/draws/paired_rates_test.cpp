// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/pass_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "binomial.h"

namespace landfall {
namespace {

TEST(McNemar, EqualsTheEnumerationOfAllCoins) {
  for (std::int64_t n = 1; n <= 60; ++n) {
    const std::vector<double> mass = binomial(n, 0.5);
    for (std::int64_t b = 0; b <= n; ++b) {
      double tail = 0;
      for (std::int64_t k = 0; k <= std::min(b, n - b); ++k) tail += mass[static_cast<std::size_t>(k)];
      ASSERT_NEAR(mcnemar_p({7, b, n - b, 11}), std::min(1.0, 2 * tail), 1e-13) << b << " and " << n - b;
    }
  }
}

TEST(McNemar, ByHand) {
  EXPECT_EQ(mcnemar_p({5, 0, 0, 3}), 1);
  EXPECT_EQ(mcnemar_p({5, 4, 4, 3}), 1);
  EXPECT_DOUBLE_EQ(mcnemar_p({0, 5, 0, 0}), 2.0 / 32);
  EXPECT_DOUBLE_EQ(mcnemar_p({0, 0, 5, 0}), 2.0 / 32);
  EXPECT_DOUBLE_EQ(mcnemar_p({1, 1, 7, 12}), 2.0 * 9 / 256);  // Bentur et al. 2009: P = 0.0703
}

TEST(Newcombe, PublishedIntervals) {
  struct Published {
    PairedCounts counts;
    double value, low, high;
  };
  const std::vector<Published> all = {
      {{36, 12, 2, 0}, 0.2000, 0.0569, 0.3404},      // Newcombe 1998, method 10
      {{59, 6, 16, 80}, -0.0621, -0.1186, -0.0046},  // Fagerland et al. 2017, chapter 8: Cavo 2012
      {{1, 1, 7, 12}, -0.2857, -0.5069, -0.0256}};   // the same: Bentur 2009
  for (const Published& case_of : all) {
    const ProbabilityDifference difference = newcombe_difference(case_of.counts);
    EXPECT_NEAR(difference.value, case_of.value, 5e-5);
    EXPECT_NEAR(difference.low, case_of.low, 5e-5);
    EXPECT_NEAR(difference.high, case_of.high, 5e-5);
  }
}

/// Without a margin the pairs have no correlation: the interval of independent rates, whose parts add as
/// squares.
TEST(Newcombe, ZeroMarginsGiveTheIntervalOfIndependentRates) {
  const ProbabilityDifference difference = newcombe_difference({2, 3, 0, 0});
  const ProbabilityInterval a = wilson({5, 5});
  const ProbabilityInterval b = wilson({2, 5});
  EXPECT_DOUBLE_EQ(difference.low, 0.6 - std::hypot(1 - a.low, b.high - 0.4));
  EXPECT_DOUBLE_EQ(difference.high, 0.6 + std::hypot(a.high - 1, 0.4 - b.low));
}

TEST(Newcombe, ContainsTheDifferenceStaysWithinItsBoundsAndChangesSignWithTheSides) {
  for (std::int64_t a = 0; a <= 12; ++a)
    for (std::int64_t b = 0; b <= 12; ++b)
      for (std::int64_t c = 0; c <= 12; ++c)
        for (std::int64_t d = 0; d <= 12; ++d) {
          const ProbabilityDifference x = newcombe_difference({a, b, c, d});
          const ProbabilityDifference y = newcombe_difference({a, c, b, d});
          ASSERT_LE(x.low, x.value);
          ASSERT_LE(x.value, x.high);
          ASSERT_GE(x.low, -1 - 1e-12);
          ASSERT_LE(x.high, 1 + 1e-12);
          ASSERT_NEAR(x.low, -y.high, 1e-14);
          ASSERT_EQ(x.value, -y.value);
        }
}

}  // namespace
}  // namespace landfall
