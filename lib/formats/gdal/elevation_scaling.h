// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "formats/gdal/raster_statement.h"

namespace landfall {

/// The band's own scale and offset, else those of the array, which some drivers leave out. Throws FormatError
/// where they are 0 or not finite.
[[nodiscard]] Scaling packing_of(const OpenRaster& raster, const DemBase& dem,
                                 const std::optional<FileArray>& array);

/// Metres from raw samples: their packing, then the unit that
/// the band (GDALRasterBand::GetUnitType(); netCDF `units`), the array, the label (PDS3 UNIT) or the vertical
/// part of the CRS declares; metres where none does, with a sentence in `assumed` where the
/// map is not in metres. Elevations that count downwards change their sign, with such a sentence.
/// DemBase::vertical_scale overrides unit and sign: the terrain applies it.
///
/// Throws FormatError, naming both units and how to override them, where two of them disagree, and where one
/// is not a known unit of length.
[[nodiscard]] Scaling elevation_scaling(const OpenRaster& raster, const DemBase& dem,
                                        const std::optional<FileArray>& array, RasterStatement& statement);

}  // namespace landfall
