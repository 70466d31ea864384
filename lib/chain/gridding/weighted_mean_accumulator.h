// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/memory/zeroed_memory.h"
#include "chain/gridding/accumulator.h"
#include "chain/gridding/bin_kernel.h"
#include "chain/gridding/bin_sums.h"
#include "chain/gridding/tile_partition.h"

namespace landfall {

/// Weighted sums per bin: the DEM construction of Chen et al., Eqs. 8-9 (`bilinear_nearest`), and the same
/// sums without weights (`mean`).
///
/// A return lands in one bin, the one whose centre is nearest in x and in y to its estimated position
/// (GridSpec::bin_of); it never spreads to neighbours. Its weight is w = (1 - p)(1 - q), p = |x_est - X|/s, q
/// = |y_est - Y|/s, (X, Y) the bin's centre, s the bin's edge: weights lie in [1/4, 1]. The paper does not
/// state the division by s (D3).
///
/// Sums are in double and each bin adds its returns in the order of arrival: the same bits at any number of
/// threads and for any division into batches. O(1) per return; 80 bytes per bin, in pages that stay untouched
/// until a return falls on them, and up to 8 bytes per point of at most 1 M points at a time.
class WeightedMeanAccumulator final : public Accumulator {
 public:
  using Weights = BinWeights;
  explicit WeightedMeanAccumulator(const GridSpec& spec, Weights weights = Weights::bilinear);

  void add(const GridPoints& points) override;
  void values(BinIndex first, std::span<BinValues> out) const override;
  void take_values(BinIndex first, std::span<BinValues> out) override;
  [[nodiscard]] bool forgets() const override { return true; }

  /// Row-major, y ascending.
  [[nodiscard]] std::span<const BinSums> bins() const { return bins_.values(); }

 private:
  std::size_t add_piece(const GridPoints& points);
  std::size_t add_part(const GridPoints& points, std::span<const std::uint64_t> part);

  Weights weights_;
  ZeroedArray<BinSums> bins_;
  std::optional<TilePartition> partition_;  ///< none on one thread
};

}  // namespace landfall
