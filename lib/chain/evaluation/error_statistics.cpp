// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D62
#include "chain/evaluation/error_statistics.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/numerics/portable_math.h"
#include "chain/evaluation/piecewise.h"
#include "chain/evaluation/quantile/order_statistics.h"

namespace landfall {
namespace {

/// The ratio of the standard deviation to the median absolute deviation of a normal distribution.
constexpr double kNormalPerDeviation = 1.4826;

/// `of` applied to the region's errors; NaN elsewhere.
template <class Of>
auto in_region(const Grid<double>& error, const BinMask& region, const Of& of) {
  return [errors = error.values(), mask = region.values(), of](std::size_t i) {
    return mask[i] != 0 ? of(errors[i]) : std::numeric_limits<double>::quiet_NaN();
  };
}

constexpr auto kItself = [](double e) { return e; };
constexpr auto kSquare = [](double e) { return e * e; };

/// Errors of the region by bucket, and their sum, in one pass.
struct FirstPass {
  CountedSum sum;
  BucketCounts counts;
};

template <class ErrorAt>
FirstPass first_pass(std::size_t bins, const ErrorAt& error_at) {
  std::vector<BucketCounts> counts((bins + kValuesPerPiece - 1) / kValuesPerPiece);
  const auto sums = by_piece(bins, [&](std::size_t begin, std::size_t end) {
    BucketCounts piece = no_counts(bins);
    CountedSum sum;
    for (std::size_t i = begin; i < end; ++i) {
      const double e = error_at(i);
      count_value(piece, e);
      sum.add(e);
    }
    counts[begin / kValuesPerPiece] = std::move(piece);
    return sum;
  });
  return {total(sums), sum_of_counts(counts)};
}

/// The buckets that hold the quantiles, found from the counts.
struct Ranges {
  BucketRange median;
  BucketRange le90;  ///< of magnitudes, like p95
  BucketRange p95;

  explicit Ranges(const BucketCounts& counts) : median(*find_buckets(counts, 0.5)) {
    const BucketCounts magnitudes = counts_of_magnitudes(counts);
    le90 = *find_buckets(magnitudes, 0.9);
    p95 = *find_buckets(magnitudes, 0.95);
  }
};

/// The values of these ranges by piece, and the squared deviations from the mean, in one pass.
struct SecondPass {
  CountedSum squares;
  std::vector<std::vector<double>> median, le90, p95;
};

template <class ErrorAt>
SecondPass second_pass(std::size_t bins, const ErrorAt& error_at, const Ranges& ranges, double mean) {
  SecondPass result;
  const std::size_t pieces = (bins + kValuesPerPiece - 1) / kValuesPerPiece;
  for (auto* values : {&result.median, &result.le90, &result.p95}) values->resize(pieces);
  const auto squares = by_piece(bins, [&](std::size_t begin, std::size_t end) {
    const std::size_t piece = begin / kValuesPerPiece;
    CountedSum sum;
    for (std::size_t i = begin; i < end; ++i) {
      const double e = error_at(i);
      sum.add((e - mean) * (e - mean));
      const std::size_t bucket = ValueBucket::of(e);
      const std::size_t of_magnitude = ValueBucket::of_magnitude(bucket);
      if (ranges.median.holds(bucket)) result.median[piece].push_back(e);
      if (ranges.le90.holds(of_magnitude)) result.le90[piece].push_back(std::abs(e));
      if (ranges.p95.holds(of_magnitude)) result.p95[piece].push_back(std::abs(e));
    }
    return sum;
  });
  result.squares = total(squares);
  return result;
}

}  // namespace

ErrorStatistics error_statistics(const Grid<double>& error, const BinMask& region) {
  const std::size_t bins = region.spec().size();
  const auto error_at = in_region(error, region, kItself);
  const FirstPass first = first_pass(bins, error_at);
  ErrorStatistics result{.count = first.sum.count};
  if (first.sum.count == 0) return result;
  const double mean = first.sum.mean();
  const Ranges ranges(first.counts);
  const SecondPass second = second_pass(bins, error_at, ranges, mean);
  const double std = std::sqrt(second.squares.mean());
  const double median = value_at_rank(second.median, ranges.median.rank);
  const auto deviation = [=](double e) { return std::abs(e - median); };
  result.mean_m = mean;
  result.std_m = std;
  result.rmse_m = portable::hypot(mean, std);
  result.median_m = median;
  result.nmad_m = kNormalPerDeviation * *quantile_of(bins, in_region(error, region, deviation), 0.5);
  result.le90_m = value_at_rank(second.le90, ranges.le90.rank);
  result.p95_m = value_at_rank(second.p95, ranges.p95.rank);
  return result;
}

HorizontalStatistics horizontal_statistics(const Grid<double>& horizontal, const BinMask& region) {
  const std::size_t bins = region.spec().size();
  const CountedSum squares = counted_sum(bins, in_region(horizontal, region, kSquare));
  if (squares.count == 0) return {.count = 0};
  return {.count = squares.count,
          .ce90_m = quantile_of(bins, in_region(horizontal, region, kItself), 0.9),
          .rmse_m = std::sqrt(squares.mean())};
}

}  // namespace landfall
