// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/zeroed_memory.h"
#include "gridding/accumulator.h"
#include "gridding/row_partition.h"
#include "gridding/weighted_mean_accumulator.h"

namespace landfall {

/// Bilinear splatting (`bilinear4`): each return contributes to the four bin centres around its estimated
/// position, with the weight (1 - |x_est - X|/s)(1 - |y_est - Y|/s) at each, (X, Y) the centre; the four
/// weights add up to 1.
///
/// Centres outside the grid and centres with weight 0 are skipped: a return exactly on a column or row of
/// centres contributes to two bins, a return on a centre to one. The count of every bin that a return reaches
/// includes it; inside_count counts it once. Order and memory (16 bytes per point and pass) are as in
/// WeightedMeanAccumulator.
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
  RowPartition north_;  ///< by the row of the two centres above a return
};

}  // namespace landfall
