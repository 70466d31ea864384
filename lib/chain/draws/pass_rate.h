// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

namespace landfall {

/// How many of n independent draws passed. 0 <= k <= n.
struct PassRate {
  std::int64_t k = 0;
  std::int64_t n = 0;
  friend bool operator==(const PassRate&, const PassRate&) = default;
};

struct ProbabilityInterval {
  double low = 0;
  double high = 1;
};

// Both functions take a confidence in (0, 1), and both are valid only where n was fixed before the first
// draw. No draw excludes no probability: n = 0 gives [0, 1] and 0, which are also the formulas' limits
// (D304).

/// Wilson's two-sided interval of the pass probability p (1927): the p with |k - n p| <= z sqrt(n p (1 - p)),
/// z the normal quantile of (1 + confidence) / 2. It contains k / n, begins at exactly 0 for k = 0 and ends
/// at exactly 1 for k = n. It covers p with the given confidence on average only: at p = 0.99 and n = 100
/// with 0.92 instead of 0.95 (docs/reference/statistics.md).
[[nodiscard]] ProbabilityInterval wilson(const PassRate& rate, double confidence = 0.95);

/// The lower bound of Clopper and Pearson (1934): the p with which k or more of n draws pass with probability
/// 1 - confidence; 0 for k = 0. It is above the true p with a probability of at most 1 - confidence, for
/// every p and n. With 95 %, 0.99 needs 299 draws without a failure, 473 with one, 628 with two.
[[nodiscard]] double exact_lower_bound(const PassRate& rate, double confidence = 0.95);

/// How many of n pairs passed on both sides, on one side only and on neither; a pair is the same draw of two
/// runs of draws, or of two arms of one. No count is negative.
struct PairedCounts {
  std::int64_t both = 0;
  std::int64_t only_a = 0;
  std::int64_t only_b = 0;
  std::int64_t neither = 0;

  [[nodiscard]] std::int64_t pairs() const { return both + only_a + only_b + neither; }
  [[nodiscard]] PassRate rate_a() const { return {both + only_a, pairs()}; }
  [[nodiscard]] PassRate rate_b() const { return {both + only_b, pairs()}; }
  friend bool operator==(const PairedCounts&, const PairedCounts&) = default;
};

/// The counts of the draws of two columns of equal length; 1 is a pass.
[[nodiscard]] PairedCounts paired_counts(std::span<const double> a, std::span<const double> b);

/// McNemar's exact two-sided test of equal pass probabilities: twice the probability that at most
/// min(only_a, only_b) of only_a + only_b fair coins show heads, at most 1; 1 if only_a + only_b is 0.
[[nodiscard]] double mcnemar_p(const PairedCounts& counts);

/// A difference of two probabilities with its interval.
struct ProbabilityDifference {
  double value = 0;
  double low = -1;
  double high = 1;
};

/// P(A passes) - P(B passes) with the interval of Newcombe's method 10 for paired proportions (Statistics in
/// Medicine 17, 1998, 2635-2650): the Wilson limits of both rates, combined with the correlation of the
/// pairs, phi = (both * neither - only_a * only_b) / sqrt of the product of the four margins, in which a
/// positive numerator is reduced by pairs/2 but not below 0. phi is 0 if a margin is 0. Without a pair: 0 in
/// [-1, 1].
[[nodiscard]] ProbabilityDifference newcombe_difference(const PairedCounts& counts, double confidence = 0.95);

}  // namespace landfall
