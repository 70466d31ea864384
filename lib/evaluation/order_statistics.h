// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
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

/// How many values each bucket holds, the NaN last.
using BucketCounts = std::vector<std::uint32_t>;

/// The order statistics that a quantile lies between, and the buckets that hold them.
struct BucketRange {
  QuantileRank rank;  ///< among the values of the buckets
  std::size_t first = 0;
  std::size_t last = 0;  ///< with it

  [[nodiscard]] bool holds(double value) const {
    const std::size_t bucket = ValueBucket::of(value);
    return bucket >= first && bucket <= last;
  }
  [[nodiscard]] std::size_t count_in(const BucketCounts& counts) const;
};

/// From the counts of the pieces. Nothing where all are NaN.
[[nodiscard]] std::optional<BucketRange> find_buckets(const std::vector<BucketCounts>& counts_by_piece,
                                                      double q);

/// The value at a rank of the pieces' values together, each with one more behind them. A zero is +0.
[[nodiscard]] double value_at_rank(const std::vector<std::vector<double>>& pieces, const QuantileRank& rank);

/// Quantiles (quantile.h) of the values that count. A selection would copy all values and move them about;
/// this counts them by bucket, once, and for each quantile copies those of one or two buckets.
template <ValueAt F>
class Quantiles {
 public:
  Quantiles(std::size_t count, F value_at)
      : count_(count),
        value_at_(std::move(value_at)),
        counts_(by_piece(count, [&](std::size_t begin, std::size_t end) {
          BucketCounts piece(ValueBucket::kCount + 1);
          for (std::size_t i = begin; i < end; ++i) ++piece[ValueBucket::of(value_at_(i))];
          return piece;
        })) {}

  /// Nothing without a value.
  [[nodiscard]] std::optional<double> at(double q) const {
    const std::optional<BucketRange> range = find_buckets(counts_, q);
    if (!range) return std::nullopt;
    const auto values = by_piece(count_, [&](std::size_t begin, std::size_t end) {
      // Every value is written and only those of the buckets stay: a branch would cost more than the store.
      std::vector<double> piece(range->count_in(counts_[begin / kValuesPerPiece]) + 1);
      double* next = piece.data();
      for (std::size_t i = begin; i < end; ++i) {
        *next = value_at_(i);
        next += range->holds(*next) ? 1 : 0;
      }
      return piece;
    });
    return value_at_rank(values, range->rank);
  }

 private:
  std::size_t count_;
  F value_at_;
  std::vector<BucketCounts> counts_;
};

/// One quantile.
template <ValueAt F>
[[nodiscard]] std::optional<double> quantile_of(std::size_t count, const F& value_at, double q) {
  return Quantiles(count, value_at).at(q);
}

}  // namespace landfall
