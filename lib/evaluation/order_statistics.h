// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "evaluation/piecewise.h"
#include "evaluation/quantile.h"

namespace landfall {

/// Numbers the values that share their sign, exponent and leading four bits, in ascending order.
struct ValueBucket {
  static constexpr std::size_t kCount = std::size_t{1} << 16U;
  /// kCount for NaN.
  [[nodiscard]] static std::size_t of(double value) {
    if (std::isnan(value)) return kCount;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;
    return static_cast<std::size_t>(((bits & kSign) != 0 ? ~bits : bits | kSign) >> 48U);
  }
};

/// The order statistics that a quantile lies between, and the buckets that hold them.
struct BucketRange {
  QuantileRank rank;  ///< among the values of the buckets
  std::size_t first = 0;
  std::size_t last = 0;  ///< with it
};

/// From how many values each bucket holds, the NaN last, by piece. Nothing where all are NaN.
[[nodiscard]] std::optional<BucketRange> find_buckets(
    const std::vector<std::vector<std::uint32_t>>& counts_by_piece, double q);

/// The value at a rank of the pieces' values together. A zero is +0.
[[nodiscard]] double value_at_rank(const std::vector<std::vector<double>>& pieces, const QuantileRank& rank);

/// The q-quantile (quantile.h) of the values that count, nothing without one. A selection would copy all
/// values and move them about; this counts them by bucket and copies those of one or two buckets.
template <ValueAt F>
[[nodiscard]] std::optional<double> quantile_of(std::size_t count, const F& value_at, double q) {
  const auto counts = by_piece(count, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> piece(ValueBucket::kCount + 1);
    for (std::size_t i = begin; i < end; ++i) ++piece[ValueBucket::of(value_at(i))];
    return piece;
  });
  const std::optional<BucketRange> range = find_buckets(counts, q);
  if (!range) return std::nullopt;
  const auto values = by_piece(count, [&](std::size_t begin, std::size_t end) {
    std::vector<double> piece;
    for (std::size_t i = begin; i < end; ++i) {
      const double value = value_at(i);
      const std::size_t bucket = ValueBucket::of(value);
      if (bucket >= range->first && bucket <= range->last) piece.push_back(value);
    }
    return piece;
  });
  return value_at_rank(values, range->rank);
}

}  // namespace landfall
