// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/raster/grid.h"

namespace landfall {

/// A bin of a small hole, with the nearest square ring about it that holds a value: the bins at that
/// Chebyshev distance.
struct FillableBin {
  BinIndex bin;
  std::int64_t ring = 0;
};

/// The NaN bins of 8-connected groups of at most `max_bins` that do not touch the map's border, row-major.
[[nodiscard]] std::vector<FillableBin> small_holes(const Grid<double>& map, std::int64_t max_bins);

/// The mean of the layer's finite values in the bin's ring, row by row from its south-west corner; NaN if
/// there are none.
[[nodiscard]] double ring_mean(const Grid<double>& layer, const FillableBin& hole);

/// Gives each of the bins the mean of its ring, of the values before any is filled.
void fill_holes(Grid<double>& layer, const std::vector<FillableBin>& holes);

}  // namespace landfall
