// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/order_statistics.h"

#include <numeric>

namespace landfall {
namespace {

std::vector<std::size_t> counts_of_all(const std::vector<BucketCounts>& pieces) {
  std::vector<std::size_t> all(ValueBucket::kCount);
  for (const BucketCounts& piece : pieces)
    for (std::size_t bucket = 0; bucket < all.size(); ++bucket) all[bucket] += piece[bucket];
  return all;
}

}  // namespace

std::size_t BucketRange::count_in(const BucketCounts& counts) const {
  const auto begin = counts.begin() + static_cast<std::ptrdiff_t>(first);
  return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(last - first + 1), std::size_t{0});
}

std::optional<BucketRange> find_buckets(const std::vector<BucketCounts>& counts_by_piece, double q) {
  const std::vector<std::size_t> counts = counts_of_all(counts_by_piece);
  const std::size_t size = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  if (size == 0) return std::nullopt;
  BucketRange result{.rank = quantile_rank(size, q)};
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
  for (const std::vector<double>& piece : pieces) values.insert(values.end(), piece.begin(), piece.end() - 1);
  return value_at_rank(std::span(values), rank) + 0.0;
}

}  // namespace landfall
