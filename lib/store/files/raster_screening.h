// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "chain/terrain/relief/dem_raster.h"

namespace landfall {

/// For use before GDAL opens a raster: throws FormatError if an HDF5 file that its name leads to
/// (named_dem_files() of formats/gdal/gdal_loader.h) is refused by h5::screen_file() (file_screening.h).
/// Files of other formats are not opened.
void screen_raster(const DemBase& dem, RasterLinks links);

}  // namespace landfall
