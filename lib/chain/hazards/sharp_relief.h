// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/raster/grid.h"
#include "base/raster/region.h"

namespace landfall {

/// Whether rocks, walls or steps stand out of a map's relief; p_safe is less sure next to them (D464). The
/// curvature of a bin is its difference from the mean of its four neighbours. True if the hundredth of the
/// region's bins with the largest curvatures has more than a sixth of the sum of squares; also if this holds
/// for blocks of 2 x 2 bins, whose noise is smaller. For normal relief or noise the share is a twelfth. Bins
/// next to a hole do not count. `region` has the spec of z.
[[nodiscard]] bool has_sharp_relief(const Grid<double>& z, const BinMask& region);

}  // namespace landfall
