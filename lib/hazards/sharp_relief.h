// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "raster/grid.h"
#include "raster/region.h"

namespace landfall {

/// Whether rocks, walls or steps stand out of a map's relief, beside which p_safe is less sure (D464): the
/// sharpest hundredth of the region's bins has more than a sixth of the sum of squared curvatures, a bin less
/// the mean of the four beside it; or that of the map of 2 x 2 bins, less noisy, does. Of normal relief or
/// noise it has a twelfth. Bins beside a hole do not count. `region` has the spec of z.
[[nodiscard]] bool has_sharp_relief(const Grid<double>& z, const BinMask& region);

}  // namespace landfall
