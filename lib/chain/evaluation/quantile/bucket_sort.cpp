// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/bucket_sort.h"

#include <algorithm>
#include <cmath>

namespace landfall {
namespace {

constexpr std::size_t kFew = 24;  // for fewer values a plain sort is faster

bool larger(const TailBin& a, const TailBin& b) { return a.value > b.value; }

}  // namespace

void BucketSort::sort(std::span<TailBin> bins, std::size_t level) {
  if (std::ranges::is_sorted(bins, larger)) return;
  const Buckets buckets = bins.size() > kFew && level < kLevels ? buckets_for(bins) : Buckets{};
  // Without a usable width: few bins, or values so close that dividing by their range overflows.
  if (!(buckets.per_unit > 0) || std::isinf(buckets.per_unit)) {
    std::ranges::sort(bins, larger);
    return;
  }
  deal(bins, buckets, levels_[level]);
  std::size_t begin = 0;
  for (const std::size_t end : levels_[level].ends) {
    if (end - begin > 1) sort(bins.subspan(begin, end - begin), level + 1);
    begin = end;
  }
}

BucketSort::Buckets BucketSort::buckets_for(std::span<const TailBin> bins) {
  const auto [lowest, highest] = std::ranges::minmax(bins, {}, &TailBin::value);
  return {highest.value, static_cast<double>(bins.size() - 1) / (highest.value - lowest.value)};
}

void BucketSort::deal(std::span<TailBin> bins, const Buckets& buckets, Level& level) {
  level.ends.assign(bins.size() + 1, 0);
  for (const TailBin& bin : bins) ++level.ends[buckets.of(bin) + 1];
  for (std::size_t i = 1; i < level.ends.size(); ++i) level.ends[i] += level.ends[i - 1];
  level.dealt.assign(bins.begin(), bins.end());
  for (const TailBin& bin : level.dealt) bins[level.ends[buckets.of(bin)]++] = bin;
}

}  // namespace landfall
