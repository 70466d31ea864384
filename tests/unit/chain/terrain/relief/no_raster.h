// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/core/error.h"
#include "chain/terrain/relief/terrain_generator.h"

namespace landfall {

/// Loads the rasters of a terrain that has none.
inline DemRaster no_raster(const DemBase&, const GridSpec&) { throw IoError("no raster in this test"); }

}  // namespace landfall
