// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "evaluation/region.h"
#include "evaluation/window_mean.h"

namespace landfall {

/// What Eq. 12 is computed from. The grids share one spec; the caller keeps them alive.
struct WindowQuantileInput {
  const Grid<double>& error;   ///< finite or NaN, metres
  const WindowMeans& windows;  ///< window_means(error, half_bins)
  const BinMask& region;       ///< windows are computed where it is set
  std::int64_t half_bins = 0;  ///< the window is 2 half_bins + 1 bins square, clipped at the border
  double quantile = 0.95;      ///< in [0, 1]
};

/// Eq. 12: for each bin of the region, the quantile (quantile.h) of |error - mean| over the valid bins of its
/// window. NaN outside the region and where the window has no valid bin.
///
/// The obvious way, a selection in each window: O(window) per bin, 31 s of CPU for one axis of the paper's
/// map. It is the oracle of any faster one, which must equal it to the last bit: the subtraction, the
/// rank and the interpolation are each rounded once, in double. Parallel by rows.
[[nodiscard]] Grid<double> window_quantile_naive(const WindowQuantileInput& input,
                                                 const ProgressCallback& progress = {});

}  // namespace landfall
