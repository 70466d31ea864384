// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/raster/footprint.h"
#include "base/raster/grid.h"

namespace landfall {

/// The mean of each bin's window and the number of valid (not NaN) bins in it. Where the count is 0 the mean
/// is std::numeric_limits<double>::quiet_NaN().
struct WindowMeans {
  Grid<double> mean;
  Grid<std::int32_t> count;
};

/// The window of a bin is the footprint about it, clipped at the grid's border (Eq. 11). Values are finite or
/// NaN; NaN is ignored.
///
/// The sum is a fixed tree, so that any faster version can and must be equal to the last bit. For a span of
/// half width w, v being the values with NaN as +0,
///   S(r, c, w) = ((0 + v(r, c - w)) + v(r, c - w + 1)) + .. + v(r, c + w)  in a square: left to right;
///   S(r, c, w) = (S(r, c, w - 1) + v(r, c - w)) + v(r, c + w), S(r, c, 0) = 0 + v(r, c)
///                                                  in another footprint: outwards, one sum for all widths;
///   sum(r, c) = ((0 + S(r - h, c, w(h))) + S(r - h + 1, c, w(h - 1))) + ..  from the lowest row up;
///   mean = sum / count.
/// Bins outside the grid count as +0, which changes no bit: a sum that begins at +0 is never -0. Sums are not
/// updated by sliding: O(half_bins) per bin, parallel by rows.
[[nodiscard]] WindowMeans window_means(const Grid<double>& values, const Footprint& footprint);

}  // namespace landfall
