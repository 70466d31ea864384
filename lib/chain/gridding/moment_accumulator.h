// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "base/memory/zeroed_memory.h"
#include "chain/gridding/row_partition.h"
#include "chain/gridding/weighted_mean_accumulator.h"

namespace landfall {

/// The moments of a bin's returns that the uncertainty map needs besides BinSums. dx and dy are relative to
/// the bin's centre, dz to its z_first, so that single precision is enough: the relative error of a sum of n
/// returns is about n 6e-8.
struct BinMoments {
  float w_w;  ///< sum w^2
  float w_dx_dx;
  float w_dx_dy;
  float w_dy_dy;
  float w_dx_dz;
  float w_dy_dz;
};

/// Second moments per bin, for a WeightedMeanAccumulator of the same grid and with its weights. Returns
/// are added in the same order at any number of threads, which gives the same bits. 24 bytes per bin,
/// untouched until a return falls on it.
class MomentAccumulator {
 public:
  explicit MomentAccumulator(const GridSpec& spec);

  /// Adds returns that `bins` already holds: call it with each batch after bins.add(), which fixes
  /// z_first.
  void add(const GridPoints& points, const WeightedMeanAccumulator& bins);

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// Row-major, y ascending.
  [[nodiscard]] std::span<const BinMoments> bins() const { return moments_.values(); }

 private:
  GridSpec spec_;
  ZeroedArray<BinMoments> moments_;
  NearestBins nearest_;
};

}  // namespace landfall
