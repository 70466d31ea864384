// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/zeroed_memory.h"
#include "gridding/accumulator.h"
#include "gridding/chosen_return.h"
#include "gridding/nearest_bins.h"

namespace landfall {

/// The lowest or the highest return of each bin (`min`, `max`): all values are those of that single return,
/// the first of several equal ones; count and z_spread cover all returns of the bin. A return belongs to the
/// bin whose centre is nearest. 80 bytes per bin; otherwise like WeightedMeanAccumulator.
class ExtremeAccumulator final : public Accumulator {
 public:
  enum class Which { lowest, highest };
  ExtremeAccumulator(const GridSpec& spec, Which which);

  void add(const GridPoints& points) override;
  void values(BinIndex first, std::span<BinValues> out) const override;

 private:
  /// Zero bytes are an empty bin.
  struct Bin {
    ChosenReturn chosen;
    double z_first, dz, dz_dz;  ///< sums relative to the first return, as in BinSums
    std::int32_t count;
  };
  [[nodiscard]] static BinValues values_of(const Bin& bin);
  void add_point(const GridPoints& points, std::size_t i, Bin& bin) const;

  Which which_;
  ZeroedArray<Bin> bins_;
  NearestBins nearest_;
};

}  // namespace landfall
