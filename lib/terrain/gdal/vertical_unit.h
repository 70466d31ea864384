// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "terrain/gdal/open_raster.h"

namespace landfall {

/// Metres per unit of a raster's elevations, after the band's scale and offset: the unit that the band
/// declares (GDALRasterBand::GetUnitType(); netCDF `units`), or the vertical part of the CRS; 1 where neither
/// does. DemBase::vertical_scale overrides both: the result is then 1, and the terrain applies the factor.
///
/// Throws FormatError, naming both units and how to override them, where band and CRS disagree, and where the
/// band's unit is not a known unit of length.
[[nodiscard]] double metres_per_elevation_unit(const OpenRaster& raster, const DemBase& dem);

}  // namespace landfall
