// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/raster/grid.h"

namespace landfall {

/// The largest value in each bin's square window of 2 half_bins + 1 bins, clipped at the grid's border.
/// Values are finite or NaN; NaN is ignored, and a window of NaN alone has NaN. half_bins >= 0, also beyond
/// the grid.
///
/// Along rows, then along columns, three comparisons per bin and direction for any window: M. van Herk,
/// Pattern Recognition Letters 13 (1992) 517; J. Gil and M. Werman, IEEE PAMI 15 (1993) 504.
[[nodiscard]] Grid<double> window_max(const Grid<double>& values, std::int64_t half_bins);

/// The smallest value, in the same way.
[[nodiscard]] Grid<double> window_min(const Grid<double>& values, std::int64_t half_bins);

}  // namespace landfall
