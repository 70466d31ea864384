// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gdal_priv.h>

#include "terrain/gdal/gdal_errors.h"
#include "terrain/gdal/site_frame.h"

namespace landfall {

struct OpenRaster {
  GDALDatasetUniquePtr dataset;
  GDALRasterBand* band;
  RasterSize size;
};

/// Opens the band of a DemBase and judges it by what its header says, before a sample is read. Throws
/// UsageError for a band that does not exist; FormatError where it or a file that it names is a pipe or
/// device, where it cannot be opened, is smaller than 2 x 2, is complex-valued, has blocks of more than 256
/// MiB or is shorter than it must be. Messages say what can be done.
[[nodiscard]] OpenRaster open_raster(const DemBase& dem, const GdalErrors& errors);

/// What the raster says about its place. Points into the raster.
[[nodiscard]] Georeference georeference(const OpenRaster& raster);

}  // namespace landfall
