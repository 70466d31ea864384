// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D451
#include "chain/evaluation/assumptions.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <vector>

#include "chain/evaluation/piecewise.h"

namespace landfall {
namespace {

/// The numbers of returns of bins: most bins hold few, which are counted, the others are kept.
struct ReturnNumbers {
  std::array<std::int64_t, 256> bins_with{};
  std::vector<std::int32_t> larger;

  void add(std::int32_t returns) {
    if (const auto number = static_cast<std::size_t>(returns); number < bins_with.size())
      ++bins_with[number];
    else
      larger.push_back(returns);
  }
  void add(const ReturnNumbers& other) {
    std::ranges::transform(bins_with, other.bins_with, bins_with.begin(), std::plus());
    larger.insert(larger.end(), other.larger.begin(), other.larger.end());
  }
  [[nodiscard]] std::int64_t count() const {
    return std::accumulate(bins_with.begin(), bins_with.end(), static_cast<std::int64_t>(larger.size()));
  }
  /// The number of the given rank, from 0, in ascending order. Orders the larger ones.
  [[nodiscard]] std::int32_t at(std::int64_t rank) {
    std::size_t number = 0;
    for (; number < bins_with.size() && rank >= bins_with[number]; ++number) rank -= bins_with[number];
    if (number < bins_with.size()) return static_cast<std::int32_t>(number);
    std::ranges::nth_element(larger, larger.begin() + rank);
    return larger[static_cast<std::size_t>(rank)];
  }
};

/// The numbers of the region's bins that hold returns.
ReturnNumbers numbers_of(const Grid<std::int32_t>& count, const BinMask& region) {
  const std::vector<ReturnNumbers> pieces =
      by_piece(region.spec().size(), [&](std::size_t begin, std::size_t end) {
        ReturnNumbers piece;
        for (std::size_t i = begin; i < end; ++i)
          if (region.values()[i] != 0 && count.values()[i] > 0) piece.add(count.values()[i]);
        return piece;
      });
  ReturnNumbers result;
  for (const ReturnNumbers& piece : pieces) result.add(piece);
  return result;
}

}  // namespace

AssumptionMetrics assumptions_of(const DemLayers& dem, const BinMask& region, const Footprint& footprint) {
  AssumptionMetrics result{.footprint_bins = footprint.edge_bins()};
  if (dem.truth) result.truth_spacing_m = dem.truth_spacing_m;
  if (!dem.count) return result;
  ReturnNumbers numbers = numbers_of(*dem.count, region);
  const std::int64_t bins = numbers.count();
  if (bins == 0) return result;
  result.single_return_frac = static_cast<double>(numbers.bins_with[1]) / static_cast<double>(bins);
  result.median_returns_per_bin =
      (numbers.at((bins - 1) / 2) + static_cast<double>(numbers.at(bins / 2))) / 2;
  return result;
}

}  // namespace landfall
