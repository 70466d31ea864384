// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D3
#include "chain/gridding/weighted_mean_accumulator.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <vector>

#include "base/core/parallel.h"

namespace landfall {
namespace {

/// The number of points per pass: the partition's own memory stays below 8 MB for any size of batch.
constexpr std::size_t kPointsPerMeanPass = std::size_t{1} << 20U;

/// Parts per thread: more parts balance the work, but scatter the points of each part more.
constexpr std::size_t kPartsPerThread = 2;

/// Shorter runs of points are copied together with others.
constexpr std::size_t kLongRun = 256;

/// Copies scattered points into contiguous memory.
class GatheredPoints {
 public:
  [[nodiscard]] bool is_empty() const { return count_ == 0; }
  /// True if the points of one more word may not fit.
  [[nodiscard]] bool is_full() const { return count_ + kPointsPerWord > kRoom; }
  /// Adds the points from `begin` on whose bits are set.
  void append(std::size_t begin, std::uint64_t bits) {
    for (; bits != 0; bits &= bits - 1)
      numbers_[count_++] =
          static_cast<std::uint32_t>(begin) + static_cast<std::uint32_t>(std::countr_zero(bits));
  }
  /// Copies the added points and clears the list. The result is valid until the next call.
  GridPoints take(const GridPoints& p) {
    GridPoints::Columns columns = p.columns();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      for (std::size_t i = 0; i < count_; ++i) columns_[c][i] = columns[c][numbers_[i]];
      columns[c] = std::span(columns_[c]).first(count_);
    }
    count_ = 0;
    return GridPoints::of(columns);
  }

 private:
  static constexpr std::size_t kRoom = 256;
  std::array<std::uint32_t, kRoom> numbers_;
  std::array<std::array<double, kRoom>, 7> columns_;
  std::size_t count_ = 0;
};

/// The number of consecutive points, in whole words from word `first`, that all belong to the part.
std::size_t run_length(std::span<const std::uint64_t> part, std::size_t first) {
  std::size_t end = first;
  while (end < part.size() && part[end] == ~std::uint64_t{0}) ++end;
  return (end - first) * kPointsPerWord;
}

}  // namespace

WeightedMeanAccumulator::WeightedMeanAccumulator(const GridSpec& spec, Weights weights)
    : Accumulator(spec), weights_(weights), bins_(spec.size()) {}

void WeightedMeanAccumulator::add(const GridPoints& points) {
  std::size_t outside = 0;
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerMeanPass) {
    const GridPoints piece = points.subset(begin, std::min(kPointsPerMeanPass, points.size() - begin));
    outside += thread_count() == 1 ? add_returns(piece, spec(), weights_, bins_.values()) : add_piece(piece);
  }
  count_points(points.size(), outside);
}

std::size_t WeightedMeanAccumulator::add_piece(const GridPoints& points) {
  if (!partition_) partition_.emplace(spec(), kPartsPerThread * thread_count());
  partition_->assign(points.x_est, points.y_est);
  std::vector<std::size_t> outside(partition_->part_count());
  parallel_for(outside.size(), 1, [&](std::size_t part, std::size_t) {
    outside[part] = add_part(points, partition_->points_of_part(part));
  });
  return std::accumulate(outside.begin(), outside.end(), std::size_t{0});
}

std::size_t WeightedMeanAccumulator::add_part(const GridPoints& points, std::span<const std::uint64_t> part) {
  std::size_t outside = 0;
  GatheredPoints gathered;
  const auto add = [&](const GridPoints& some) {
    outside += add_returns(some, spec(), weights_, bins_.values());
  };
  for (std::size_t word = 0; word < part.size();) {
    if (part[word] == 0) {
      ++word;
      continue;
    }
    const std::size_t begin = word * kPointsPerWord;
    const std::size_t run = run_length(part, word);
    const bool is_long = run >= kLongRun;
    if (!gathered.is_empty() && (is_long || gathered.is_full())) add(gathered.take(points));
    if (is_long) {
      add(points.subset(begin, run));
      word += run / kPointsPerWord;
    } else {
      gathered.append(begin, part[word++]);
    }
  }
  add(gathered.take(points));
  return outside;
}

void WeightedMeanAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const BinSums> sums = bins().subspan(spec().index(first), out.size());
  std::ranges::transform(sums, out.begin(), [](const BinSums& bin) { return values_of(bin); });
}

void WeightedMeanAccumulator::take_values(BinIndex first, std::span<BinValues> out) {
  values(first, out);
  std::ranges::fill(bins_.values().subspan(spec().index(first), out.size()), BinSums{});
}

}  // namespace landfall
