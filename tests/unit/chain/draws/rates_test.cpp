// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "binomial.h"
#include "chain/draws/pass_rate.h"

namespace landfall {
namespace {

constexpr double kZ95 = 1.959963984540054;  // normal quantile of 0.975

bool contains(const ProbabilityInterval& interval, double p) {
  return interval.low <= p && p <= interval.high;
}

TEST(Wilson, PublishedValues) {
  EXPECT_NEAR(wilson({100, 100}).low, 0.963, 5e-5);
  // Newcombe 1998, Statistics in Medicine 17, Table I, method 3.
  EXPECT_NEAR(wilson({81, 263}).low, 0.2553, 5e-5);
  EXPECT_NEAR(wilson({81, 263}).high, 0.3662, 5e-5);
  EXPECT_NEAR(wilson({15, 148}).low, 0.0624, 5e-5);
  EXPECT_NEAR(wilson({15, 148}).high, 0.1605, 5e-5);
  EXPECT_NEAR(wilson({0, 20}).high, 0.1611, 5e-5);
  EXPECT_NEAR(wilson({1, 29}).low, 0.0061, 5e-5);
  EXPECT_NEAR(wilson({1, 29}).high, 0.1718, 5e-5);
}

TEST(Wilson, EndsAreTheProbabilitiesThatTheScoreTestJustAccepts) {
  for (std::int64_t n = 1; n <= 500; ++n)
    for (std::int64_t k = 0; k <= n; ++k) {
      const auto [low, high] = wilson({k, n});
      const double count = static_cast<double>(n);
      const auto distance = [&](double p) { return std::abs(static_cast<double>(k) - count * p); };
      const auto reach = [&](double p) { return kZ95 * std::sqrt(count * p * (1 - p)); };
      ASSERT_NEAR(distance(low), reach(low), 1e-9 * count) << k << " of " << n;
      ASSERT_NEAR(distance(high), reach(high), 1e-9 * count) << k << " of " << n;
      ASSERT_LE(0, low);
      ASSERT_LE(low, static_cast<double>(k) / count);
      ASSERT_GE(high, static_cast<double>(k) / count);
      ASSERT_LE(high, 1);
    }
}

TEST(Wilson, EndsAt0And1WhereAllFailOrPass) {
  for (std::int64_t n = 1; n <= 500; ++n) {
    ASSERT_EQ(wilson({0, n}).low, 0) << n;
    ASSERT_EQ(wilson({n, n}).high, 1) << n;
    ASSERT_LT(wilson({0, n}).high, 1) << n;
    ASSERT_GT(wilson({n, n}).low, 0) << n;
  }
}

/// The exact probability that the interval of n draws contains p, by summing over all k.
double wilson_coverage(double p, std::int64_t n) {
  const std::vector<double> mass = binomial(n, p);
  double covered = 0;
  for (std::int64_t k = 0; k <= n; ++k)
    if (contains(wilson({k, n}), p)) covered += mass[static_cast<std::size_t>(k)];
  return covered;
}

TEST(Wilson, CoversLessThanNominalNearOne) {
  EXPECT_NEAR(wilson_coverage(0.99, 100), 0.92063, 5e-6);
  EXPECT_LT(wilson_coverage(0.95, 100), 0.97);
  EXPECT_GT(wilson_coverage(0.95, 100), 0.95);
}

TEST(Wilson, CoversWithItsConfidenceOnAverage) {
  for (const double p : kProbabilities) {
    double sum = 0;
    double minimum = 1;
    for (std::int64_t n = 1; n <= 500; ++n) {
      const double coverage = wilson_coverage(p, n);
      sum += coverage;
      minimum = std::min(minimum, coverage);
    }
    EXPECT_NEAR(sum / 500, 0.95, 0.025) << p;
    EXPECT_GT(minimum, 0.83) << p;
  }
}

TEST(Wilson, WiderWithMoreConfidence) {
  const PassRate rate{95, 100};
  EXPECT_LT(wilson(rate, 0.99).low, wilson(rate, 0.95).low);
  EXPECT_GT(wilson(rate, 0.99).high, wilson(rate, 0.95).high);
  EXPECT_NEAR(wilson({10, 10}, 0.99).low, 10 / (10 + 2.5758293035489004 * 2.5758293035489004), 1e-14);
}

TEST(ExactLowerBound, DrawsForAProbabilityOf099) {
  EXPECT_GE(exact_lower_bound({299, 299}), 0.99);
  EXPECT_LT(exact_lower_bound({298, 298}), 0.99);
  EXPECT_GE(exact_lower_bound({472, 473}), 0.99);
  EXPECT_LT(exact_lower_bound({471, 472}), 0.99);
  EXPECT_GE(exact_lower_bound({626, 628}), 0.99);
  EXPECT_LT(exact_lower_bound({625, 627}), 0.99);
  EXPECT_GE(exact_lower_bound({459, 459}, 0.99), 0.99);
  EXPECT_LT(exact_lower_bound({458, 458}, 0.99), 0.99);
}

TEST(ExactLowerBound, ClosedFormsWhereNoneOneOrAllPass) {
  for (const double confidence : {0.5, 0.9, 0.95, 0.99, 0.999})
    for (std::int64_t n = 1; n <= 500; ++n) {
      const double count = static_cast<double>(n);
      ASSERT_EQ(exact_lower_bound({0, n}, confidence), 0);
      ASSERT_NEAR(exact_lower_bound({n, n}, confidence), std::pow(1 - confidence, 1 / count), 1e-14);
      if (n > 1) {
        ASSERT_NEAR(exact_lower_bound({1, n}, confidence), 1 - std::pow(confidence, 1 / count), 1e-14);
      }
    }
}

TEST(ExactLowerBound, LeavesOneMinusTheConfidenceToAsManyPasses) {
  for (const std::int64_t n : {1, 2, 3, 10, 47, 100, 299, 500})
    for (std::int64_t k = 1; k <= n; ++k)
      for (const double confidence : {0.95, 0.99}) {
        const double bound = exact_lower_bound({k, n}, confidence);
        ASSERT_NEAR(upper_tail(k, binomial(n, bound)), 1 - confidence, 1e-11) << k << " of " << n;
      }
}

TEST(ExactLowerBound, CoversEveryProbabilityAtLeastWithItsConfidence) {
  std::vector<std::vector<double>> bounds;
  for (std::int64_t n = 0; n <= 500; ++n) {
    bounds.emplace_back();
    for (std::int64_t k = 0; k <= n; ++k) bounds.back().push_back(exact_lower_bound({k, n}));
    ASSERT_TRUE(std::ranges::is_sorted(bounds.back(), std::less_equal<>())) << n;  // strictly
  }
  for (const double p : kProbabilities)
    for (std::size_t n = 0; n <= 500; ++n) {
      const std::vector<double> mass = binomial(static_cast<std::int64_t>(n), p);
      double covered = 0;
      for (std::size_t k = 0; k <= n; ++k)
        if (bounds[n][k] <= p) covered += mass[k];
      ASSERT_GE(covered, 0.95 - 1e-12) << p << ' ' << n;
    }
}

TEST(PassRate, NoDrawExcludesNoProbability) {
  EXPECT_EQ(wilson({0, 0}).low, 0);
  EXPECT_EQ(wilson({0, 0}).high, 1);
  EXPECT_EQ(exact_lower_bound({0, 0}), 0);
}

// Counts of many draws keep their precision.
TEST(PassRate, ManyDraws) {
  const std::int64_t n = 1'000'000'000;
  EXPECT_NEAR(exact_lower_bound({n, n}), 1 - 2.995732273553991 / 1e9, 1e-15);
  EXPECT_NEAR(wilson({n, n}).low, 1 - kZ95 * kZ95 / 1e9, 1e-15);
  EXPECT_NEAR(wilson({n / 2, n}).low, 0.5 - kZ95 / 2 / std::sqrt(1e9), 1e-12);
}

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
