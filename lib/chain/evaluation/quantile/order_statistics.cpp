// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/order_statistics.h"

#include <numeric>

namespace landfall {

BucketCounts counts_of_magnitudes(const BucketCounts& counts) {
  if (counts.size() == 2) return counts;
  BucketCounts result(counts.size());
  for (std::size_t bucket = 0; bucket < counts.size(); ++bucket)
    result[ValueBucket::of_magnitude(bucket)] += counts[bucket];
  return result;
}

BucketCounts sum_of_counts(const std::vector<BucketCounts>& counts_by_piece) {
  BucketCounts sum(counts_by_piece.empty() ? 2 : counts_by_piece.front().size());
  for (const BucketCounts& piece : counts_by_piece)
    for (std::size_t bucket = 0; bucket < sum.size(); ++bucket) sum[bucket] += piece[bucket];
  return sum;
}

std::optional<BucketRange> find_buckets(const BucketCounts& counts, double q) {
  const std::size_t size = std::accumulate(counts.begin(), counts.end() - 1, std::size_t{0});  // without NaN
  if (size == 0) return std::nullopt;
  BucketRange result{.rank = quantile_rank(size, q)};
  if (counts.size() == 2) {
    result.last = ValueBucket::kCount - 1;
    return result;
  }
  const std::size_t above = result.rank.below + (result.rank.frac > 0 ? 1 : 0);
  std::size_t before = 0;
  for (; before + counts[result.first] <= result.rank.below; ++result.first) before += counts[result.first];
  std::size_t with = before + counts[result.first];
  for (result.last = result.first; with <= above;) with += counts[++result.last];
  result.rank.below -= before;
  return result;
}

double value_at_rank(const std::vector<std::vector<double>>& pieces, const QuantileRank& rank) {
  std::vector<double> values;
  for (const std::vector<double>& piece : pieces) values.insert(values.end(), piece.begin(), piece.end());
  return value_at_rank(std::span(values), rank) + 0.0;
}

}  // namespace landfall
