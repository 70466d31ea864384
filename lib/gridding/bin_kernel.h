// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gridding/bin_sums.h"
#include "gridding/grid_points.h"
#include "raster/grid_spec.h"

namespace landfall {

enum class BinWeights { bilinear, equal };

struct AddedReturns {
  std::size_t outside = 0;  ///< returns in no bin
  bool finite = true;       ///< all seven coordinates of all returns
};

/// Adds the returns, in their order, to the bins in which they lie (row-major, those of `spec`, at most
/// 2^31 - 1), as add_return() with the weight of BinAccumulator: the same bits. In SIMD lanes by run-time
/// dispatch. The grid's first row and column lie within +-2^52.
AddedReturns add_returns(const GridPoints& points, const GridSpec& spec, BinWeights weights,
                         std::span<BinSums> bins);

/// The row of the grid in which each return lies, -1 for one outside; x, y and rows have one length.
void find_rows(const GridSpec& spec, std::span<const double> x_m, std::span<const double> y_m,
               std::span<std::int32_t> rows);

}  // namespace landfall
