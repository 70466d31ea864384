// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/raster/grid.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// The elevation of the terrain at the centre of each bin, metres; NaN where there is none. Parallel by rows.
[[nodiscard]] Grid<double> bin_elevations(const TerrainSurface& terrain, const GridSpec& grid);

}  // namespace landfall
