// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "chain/evaluation/judge/window_sums.h"
#include "chain/evaluation/quantile/quantile.h"

namespace landfall {

/// How many values of a window of n may deviate by more than the limit, with quantile.h's a[below] <=
/// a[below + 1]: if at most `pass`, a[below + 1] is within the limit (a[below], if it alone is the quantile);
/// if at least `fail`, a[below] exceeds it. Between them, which needs frac > 0, the quantile itself decides.
struct DecisiveCounts {
  std::int64_t pass = 0;
  std::int64_t fail = 0;

  /// n >= 1.
  [[nodiscard]] static DecisiveCounts of(std::int64_t n, double quantile) {
    const QuantileRank rank = quantile_rank(static_cast<std::size_t>(n), quantile);
    const std::int64_t fail = n - static_cast<std::int64_t>(rank.below);
    return {rank.frac == 0 ? fail - 1 : fail - 2, fail};
  }
};

/// An interval that holds the means of some windows.
struct MeanRange {
  double lowest;
  double highest;
};

/// Counts of one bin or, summed, of a window, in one number: the values, those that deviate by more than the
/// limit from some mean of a range, and those that deviate so from each.
struct PackedCounts {
  static constexpr unsigned kBits = 21;
  static constexpr std::int64_t kMax = (std::int64_t{1} << kBits) - 1;  ///< of each count

  std::uint64_t bits = 0;
  [[nodiscard]] std::int64_t valid() const { return part(0); }
  [[nodiscard]] std::int64_t possible() const { return part(1); }
  [[nodiscard]] std::int64_t certain() const { return part(2); }

 private:
  [[nodiscard]] std::int64_t part(unsigned i) const {
    return static_cast<std::int64_t>(bits >> (i * kBits)) & kMax;
  }
};

/// The number of values that deviate from some mean by more than the limit, and from each.
struct DeviationTotals {
  std::int64_t possible = 0;
  std::int64_t certain = 0;
};

/// Counts |e - mean| > limit, rounded as window_quantile() rounds it, for each mean of the range: rounding is
/// monotone, so the two ends decide. `packed` has as many rows and columns.
[[nodiscard]] DeviationTotals count_deviations(const View<const double>& errors, const MeanRange& means,
                                               double limit, const View<std::uint64_t>& packed);

}  // namespace landfall
