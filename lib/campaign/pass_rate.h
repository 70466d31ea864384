// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

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

}  // namespace landfall
