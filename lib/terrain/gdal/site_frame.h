// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "terrain/relief/dem_raster.h"
#include "terrain/relief/site_mapping.h"
#include "terrain/terrain_model.h"

class OGRSpatialReference;

namespace landfall {

/// The georeference of a raster.
struct Georeference {
  std::optional<GeoTransform> transform;
  const OGRSpatialReference* crs =
      nullptr;  ///< axes in longitude-latitude or easting-northing order; may be null
  RasterSize size;
  bool in_metres = false;  ///< without a CRS: the coordinates declare metres (netCDF: x:units, y:units)
};

/// The frame of a site in a raster.
struct SiteFrame {
  SiteMapping mapping;
  std::string crs_wkt;
  /// Pixel spacing, metres: the shorter edge of a cell; for a geographic raster the longer edge, because its
  /// meridians converge.
  double posting_m = 0;
};

/// Throws UsageError and FormatError as load_dem() (lib/terrain/gdal/gdal_loader.h) does.
[[nodiscard]] SiteFrame site_frame(const Georeference& georeference, const DemBase& dem);

}  // namespace landfall
