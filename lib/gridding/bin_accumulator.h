// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/zeroed_memory.h"
#include "gridding/accumulator.h"
#include "gridding/nearest_bins.h"

namespace landfall {

/// What a bin remembers of its returns: all that BinValues need. Zero bytes are an empty bin.
struct BinSums {
  double weight;    ///< sum w
  double z_first;   ///< z_est of the bin's first return, m; the next two sums are relative to it
  double w_dz;      ///< sum w (z_est - z_first): small numbers, so that squares do not cancel
  double w_dz_dz;   ///< sum w (z_est - z_first)^2
  double w_x_true;  ///< sum w x_true, and so on
  double w_y_true;
  double w_x_est;
  double w_y_est;
  double w_t;
  std::int32_t count;
};

/// The values that the sums stand for: weighted means, and z_est exact where all elevations are equal.
[[nodiscard]] BinValues values_of(const BinSums& sums);

/// Adds one return to its bin.
void add_return(const GridPoints& points, std::size_t i, double weight, BinSums& bin);

/// Weighted sums per bin: the DEM construction of Chen et al., Eqs. 8-9 (`bilinear_nearest`), and the same
/// without weights (`mean`).
///
/// A return lands in one bin, the one whose centre is nearest in x and in y by its estimated position
/// (GridSpec::bin_of); it never spreads to neighbours. Its weight is w = (1 - p)(1 - q), p = |x_est - X|/s, q
/// likewise in y, (X, Y) the bin's centre, s the bin's edge: weights lie in [1/4, 1]. The paper leaves the
/// division by s unsaid (docs/decisions.md).
///
/// Sums are in double and each bin adds its returns in the order they came in: the same bits at any number of
/// threads and for any cutting into batches. O(1) per return; 80 bytes per bin, in pages that stay untouched
/// until a return falls on them, and 8 bytes per point of at most 4 M points at a time.
class BinAccumulator final : public Accumulator {
 public:
  enum class Weights { bilinear, equal };
  explicit BinAccumulator(const GridSpec& spec, Weights weights = Weights::bilinear);

  void add(const GridPoints& points, std::int64_t first_row_number) override;
  void values(BinIndex first, std::span<BinValues> out) const override;

  /// Row-major, y ascending.
  [[nodiscard]] std::span<const BinSums> bins() const { return bins_.values(); }

 private:
  Weights weights_;
  ZeroedArray<BinSums> bins_;
  NearestBins nearest_;
};

}  // namespace landfall
