// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "chain/evaluation/piecewise.h"
#include "chain/evaluation/quantile/quantile.h"

namespace landfall {

/// Numbers the values that share their sign, exponent and leading four bits, in ascending order.
struct ValueBucket {
  static constexpr std::size_t kCount = std::size_t{1} << 16U;
  /// The bucket of a value; kCount for NaN.
  [[nodiscard]] static std::size_t of(double value) {
    if (std::isnan(value)) return kCount;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;
    return static_cast<std::size_t>(((bits & kSign) != 0 ? ~bits : bits | kSign) >> 48U);
  }
  /// The bucket of |value| from that of the value.
  [[nodiscard]] static std::size_t of_magnitude(std::size_t bucket) {
    return bucket < kCount / 2 ? kCount - 1 - bucket : bucket;
  }
};

/// So many values are counted in one bucket: it takes longer to clear and add 2^16 counters than to select.
inline constexpr std::size_t kFewValues = 4096;

/// The number of values in each bucket, NaN last. Two counters for few values: numbers and NaN.
using BucketCounts = std::vector<std::uint32_t>;

/// Zero for each bucket of so many values.
[[nodiscard]] inline BucketCounts no_counts(std::size_t values) {
  return BucketCounts(values <= kFewValues ? 2 : ValueBucket::kCount + 1);
}
inline void count_value(BucketCounts& counts, double value) {
  ++counts[counts.size() > 2 ? ValueBucket::of(value) : std::size_t{std::isnan(value)}];
}

/// The counts of the magnitudes: a value and its negative are counted together.
[[nodiscard]] BucketCounts counts_of_magnitudes(const BucketCounts& counts);

/// The sum of the counts of all pieces. A map has fewer than 2^32 bins.
[[nodiscard]] BucketCounts sum_of_counts(const std::vector<BucketCounts>& counts_by_piece);

/// The order statistics that a quantile lies between, and the buckets that hold them.
struct BucketRange {
  QuantileRank rank;  ///< among the values of the buckets
  std::size_t first = 0;
  std::size_t last = 0;  ///< inclusive

  [[nodiscard]] bool holds(std::size_t bucket) const { return bucket >= first && bucket <= last; }
};

/// Empty if all values are NaN.
[[nodiscard]] std::optional<BucketRange> find_buckets(const BucketCounts& counts, double q);

/// The value at a rank of the pieces' values together. A zero is +0.
[[nodiscard]] double value_at_rank(const std::vector<std::vector<double>>& pieces, const QuantileRank& rank);

/// The values of the pieces that lie in the buckets of a range.
template <ValueAt F>
[[nodiscard]] std::vector<std::vector<double>> values_in(std::size_t count, const F& value_at,
                                                         const BucketRange& range) {
  return by_piece(count, [&](std::size_t begin, std::size_t end) {
    std::vector<double> piece;
    for (std::size_t i = begin; i < end; ++i) {
      const double value = value_at(i);
      if (range.holds(ValueBucket::of(value))) piece.push_back(value);
    }
    return piece;
  });
}

/// The result of one pass over values: their sum, and of their magnitudes the largest (-infinity without a
/// value), the number above a limit, and the distribution.
struct ValueSummary {
  CountedSum sum;
  double largest = -HUGE_VAL;
  std::int64_t above = 0;
  BucketCounts counts;
};

template <ValueAt F>
[[nodiscard]] ValueSummary summarize(std::size_t count, const F& value_at, double limit) {
  std::vector<ValueSummary> pieces = by_piece(count, [&](std::size_t begin, std::size_t end) {
    ValueSummary piece;
    piece.counts = no_counts(count);
    for (std::size_t i = begin; i < end; ++i) {
      const double value = value_at(i);
      const double magnitude = std::abs(value);
      piece.sum.add(value);
      piece.largest = magnitude > piece.largest ? magnitude : piece.largest;
      piece.above += magnitude > limit ? 1 : 0;
      count_value(piece.counts, magnitude);
    }
    return piece;
  });
  ValueSummary result;
  result.counts = no_counts(count);
  for (const ValueSummary& piece : pieces) {
    result.sum.count += piece.sum.count;
    result.sum.sum += piece.sum.sum;
    result.largest = std::max(result.largest, piece.largest);
    result.above += piece.above;
    for (std::size_t bucket = 0; bucket < result.counts.size(); ++bucket)
      result.counts[bucket] += piece.counts[bucket];
  }
  return result;
}

/// One quantile (quantile.h) of the values that count; empty without a value. A selection would copy and
/// reorder all values; this counts many by bucket and copies only those of one or two buckets.
template <ValueAt F>
[[nodiscard]] std::optional<double> quantile_of(std::size_t count, const F& value_at, double q) {
  const auto counts = by_piece(count, [&](std::size_t begin, std::size_t end) {
    BucketCounts piece = no_counts(count);
    for (std::size_t i = begin; i < end; ++i) count_value(piece, value_at(i));
    return piece;
  });
  const std::optional<BucketRange> range = find_buckets(sum_of_counts(counts), q);
  if (!range) return std::nullopt;
  return value_at_rank(values_in(count, value_at, *range), range->rank);
}

}  // namespace landfall
