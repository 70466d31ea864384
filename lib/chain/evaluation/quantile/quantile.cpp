// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D23
#include "chain/evaluation/quantile/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace landfall {

QuantileRank quantile_rank(std::size_t n, double q) {
  const double h = static_cast<double>(n - 1) * q;
  const double below = std::floor(h);
  return {static_cast<std::size_t>(below), h - below};
}

double value_at_rank(std::span<double> values, const QuantileRank& rank) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank.below);
  std::nth_element(values.begin(), at, values.end());
  if (rank.frac == 0) return *at;
  return interpolate(*at, *std::min_element(at + 1, values.end()), rank.frac);
}

double quantile_in_place(std::span<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return value_at_rank(values, quantile_rank(values.size(), q));
}

}  // namespace landfall
