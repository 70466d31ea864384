// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace landfall {

/// The place of a quantile among n sorted values a[0] <= .. <= a[n-1]: h = (n - 1) q, below = floor(h), frac
/// = h - below, and its value is a[below] + frac (a[below + 1] - a[below]), or a[below] when frac is 0. This
/// is numpy's default, Hyndman and Fan's type 7.
struct QuantileRank {
  std::size_t below = 0;
  double frac = 0;
};

/// n >= 1, q in [0, 1].
[[nodiscard]] QuantileRank quantile_rank(std::size_t n, double q);

/// The value between two neighbouring order statistics. Never beyond `above`: frac < 1.
[[nodiscard]] inline double interpolate(double below, double above, double frac) {
  return below + frac * (above - below);
}

/// The value at a rank of enough values, which the function reorders. O(n).
[[nodiscard]] double value_at_rank(std::span<double> values, const QuantileRank& rank);

/// The q-quantile of the values, which the function reorders. NaN without values; no value may be NaN. O(n).
[[nodiscard]] double quantile_in_place(std::span<double> values, double q);

}  // namespace landfall
