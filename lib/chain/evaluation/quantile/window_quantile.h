// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include "base/core/progress.h"
#include "base/raster/footprint.h"
#include "base/raster/region.h"
#include "base/raster/window_mean.h"

namespace landfall {

/// The input of Eq. 12. The grids share one spec; the caller keeps them alive.
struct WindowQuantileInput {
  const Grid<double>& error;   ///< finite or NaN, metres
  const WindowMeans& windows;  ///< window_means(error, footprint)
  const Footprint& footprint;  ///< the window, clipped at the border
  const BinMask& region;       ///< windows are computed where it is set
  double quantile = 0.95;      ///< in [0, 1]
};

/// Eq. 12: for each bin of the region, the quantile (quantile.h) of |error - mean| over the valid bins of its
/// window. NaN outside the region and where the window has no valid bin.
///
/// The straightforward method, a selection in each window: O(window) per bin. It is the oracle of the faster
/// one, which must equal it to the last bit: the subtraction, the rank and the interpolation are each rounded
/// once, in double. Parallel by rows.
[[nodiscard]] Grid<double> window_quantile_naive(const WindowQuantileInput& input,
                                                 const ProgressCallback& progress = {});

/// The number of neighbouring windows that share their work.
struct QuantileTile {
  std::int64_t rows = 32;
  std::int64_t cols = 32;
};

/// The same result as window_quantile_naive(), to the last bit, for any tile of at least one window and any
/// number of threads: neighbouring windows share the sorted tails of the errors that they reach
/// (tile_quantile.h). Optimised for high quantiles of windows of many bins. Parallel by rows of tiles.
[[nodiscard]] Grid<double> window_quantile(const WindowQuantileInput& input,
                                           const ProgressCallback& progress = {},
                                           const QuantileTile& tile = {});

/// Whether the window is still to be computed: its centre is in the region, it has a valid bin, and the
/// result is NaN.
[[nodiscard]] inline bool is_pending(const WindowQuantileInput& input, const Grid<double>& result,
                                     BinIndex bin) {
  return input.region.at(bin) != 0 && input.windows.count.at(bin) != 0 && std::isnan(result.at(bin));
}

}  // namespace landfall
