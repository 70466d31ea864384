// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/site_mapping.h"
#include "chain/terrain/terrain_model.h"

class OGRSpatialReference;

namespace landfall {

/// The georeference of a raster.
struct Georeference {
  std::optional<GeoTransform> transform;
  const OGRSpatialReference* crs =
      nullptr;  ///< axes in longitude-latitude or easting-northing order; may be null
  RasterSize size;
  double metres_per_unit =
      0;  ///< of the coordinates, by the CRS or as they declare; 0: not known, or degrees
};

/// How far a raster of longitudes and latitudes continues beyond its edges: it closes around the body, and
/// beyond a pole lies the other side.
struct RasterCover {
  std::int64_t period = 0;           ///< columns around the body; 0: it does not close
  std::optional<double> first_pole;  ///< the row of the pole at the first edge: -0.5 or 0
  std::optional<double> last_pole;   ///< rows - 0.5 or rows - 1

  friend bool operator==(const RasterCover&, const RasterCover&) = default;
};

/// The frame of a site in a raster: the map's own axes where the map's scale at the site is 1 within 1e-3 and
/// its axes are at a right angle, else the orthographic frame around the centre.
struct SiteFrame {
  SiteMapping mapping;
  std::string crs_wkt;
  /// Pixel spacing, metres: the shorter edge of a cell; for a geographic raster the longer edge, because its
  /// meridians converge.
  double posting_m = 0;
  RasterCover cover;
  std::vector<std::string> assumed;  ///< of the map, as in RasterStatement
  double metres_per_unit = 0;  ///< of the map, where the site's axes are those of a map with a CRS; else 0
};

/// Throws UsageError and FormatError as load_dem() (lib/formats/gdal/gdal_loader.h) does.
[[nodiscard]] SiteFrame site_frame(const Georeference& georeference, const DemBase& dem);

}  // namespace landfall
