// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "raster/grid.h"

namespace landfall {

/// The mean of each bin's window, and the number of valid (not NaN) bins in it. Where the count is 0 the mean
/// is NaN, always the same one, std::numeric_limits<double>::quiet_NaN().
struct WindowMeans {
  Grid<double> mean;
  Grid<std::int32_t> count;
};

/// The window of a bin is the square of 2 half_bins + 1 bins about it, clipped at the grid's border (Eq. 11).
/// Values are finite or NaN; NaN is ignored.
///
/// The sum is a fixed tree, so that any faster version can be, and must be, equal to the last bit:
///   S(r, c) = ((0 + v(r, c - h)) + v(r, c - h + 1)) + .. + v(r, c + h)    left to right, NaN as +0;
///   sum(r, c) = ((0 + S(r - h, c)) + S(r - h + 1, c)) + .. + S(r + h, c)  from the lowest row up;
///   mean = sum / count.
/// Bins outside the grid are left out; adding +0 for them would give the same bits, for a sum that begins at
/// +0 is never -0. Direct sums of both passes, no sliding update: O(half_bins) per bin, parallel by rows.
[[nodiscard]] WindowMeans window_means(const Grid<double>& values, std::int64_t half_bins);

}  // namespace landfall
