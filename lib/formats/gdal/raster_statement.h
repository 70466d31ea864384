// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/gdal/file_array.h"
#include "formats/gdal/open_raster.h"
#include "formats/gdal/site_frame.h"

namespace landfall {

/// Values from raw samples: scale raw + offset.
struct Scaling {
  double scale = 1;
  double offset = 0;
};

/// All that a raster says of its geometry, its units and its invalid samples, compared before a site is read:
/// the georeference against the coordinate variables and their units, the unit of the elevations in the band,
/// in the label and in the CRS.
struct RasterStatement {
  Georeference georeference;        ///< points into the raster
  Scaling packing;                  ///< the raster's own scale and offset, before units
  Scaling elevation;                ///< metres
  std::vector<double> nodata;       ///< raw samples that are holes, in the type of the band
  std::optional<ValidRange> valid;  ///< others are holes
  /// The statements that the raster lacks or contradicts, and the assumptions instead; sentences without
  /// the file's name. Empty where all is certain.
  std::vector<std::string> assumed;
};

/// Throws FormatError, naming both values and the option that decides, where the raster contradicts itself,
/// and where a unit is not known.
[[nodiscard]] RasterStatement raster_statement(const OpenRaster& raster, const DemBase& dem);

}  // namespace landfall
