// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/zeroed_memory.h"
#include "gridding/accumulator.h"
#include "gridding/row_partition.h"
#include "gridding/weighted_mean_accumulator.h"

namespace landfall {

/// Bilinear splatting (`bilinear4`): each return counts at the four bin centres around its estimated
/// position, with the weight (1 - |x_est - X|/s)(1 - |y_est - Y|/s) at each, (X, Y) the centre; the four add
/// up to 1.
///
/// Centres outside the grid are left out, and so is one with the weight 0: a return exactly on a column or
/// row of centres counts at two, on a centre at one. A return takes part in the count of every bin that it
/// reaches; inside_count counts it once. Otherwise as WeightedMeanAccumulator: order, memory (16 bytes per
/// point and pass).
class BilinearAccumulator final : public Accumulator {
 public:
  explicit BilinearAccumulator(const GridSpec& spec);

  void add(const GridPoints& points) override;
  void values(BinIndex first, std::span<BinValues> out) const override;

 private:
  void add_pass(const GridPoints& points);
  void add_band(const GridPoints& points, std::size_t band);
  void add_to_row(const GridPoints& points, std::size_t i, bool north);

  ZeroedArray<BinSums> bins_;
  RowPartition south_;  ///< by the row of the two centres below a return
  RowPartition north_;  ///< and of those above
};

}  // namespace landfall
