// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/raster/grid.h"
#include "base/raster/grid_spec.h"

namespace landfall {

/// One byte per bin of the DEM: 1 inside, 0 outside.
using BinMask = Grid<std::int8_t>;

enum class RegionShape { circle, square, mask, polygon };

/// Whether the bins of the shape come as a mask that is made before the map is judged.
[[nodiscard]] constexpr bool has_mask(RegionShape shape) {
  return shape == RegionShape::mask || shape == RegionShape::polygon;
}

/// The bins at (i, j) bins from the centre with i^2 + j^2 < (radius_m / resolution_m)^2, strictly. Ratios
/// within 1e-9 of an integer are that integer; if all are, the comparison is exact, else it is made in
/// double. 50 m at 0.05 m about a bin's centre gives 3,141,521 bins, the paper's count: the 28 bins on the
/// circle are out.
///
/// The region fits if every bin of it lies in the DEM. Otherwise throws UsageError, naming the largest radius
/// that fits.
[[nodiscard]] BinMask circular_region(const GridSpec& dem, double radius_m, Horizontal center = {});

/// The same bins, as far as they lie in the DEM: none is too far, and there may be none at all. Lengths of
/// more than 2^30 bins count as 2^30 bins.
[[nodiscard]] BinMask clipped_circle(const GridSpec& dem, double radius_m, Horizontal center = {});

/// The bins at most half_width_m / resolution_m + 1e-9 bins from the origin along both axes. The conditions
/// and errors are those of circular_region().
[[nodiscard]] BinMask square_region(const GridSpec& dem, double half_width_m);

[[nodiscard]] std::int64_t count_set(const BinMask& mask);

/// The smallest box of rows and columns that holds some bins, inclusive. Without a bin `last` lies before
/// `first`.
struct BinBox {
  BinIndex first;
  BinIndex last;
};

/// The box of the bins of a mask, and of the bins with an elevation.
[[nodiscard]] BinBox set_box(const BinMask& mask);
[[nodiscard]] BinBox valid_box(const Grid<double>& z_est);

}  // namespace landfall
