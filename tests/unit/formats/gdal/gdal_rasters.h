// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chain/terrain/relief/site_mapping.h"

namespace landfall {

/// A raster to write: `value(col, row)` at each pixel, as the file stores it.
struct TestRaster {
  int cols = 0;
  int rows = 0;
  std::function<double(int col, int row)> value = {};
  std::string type = "Float64";  ///< type name in GDAL, or SignedByte
  std::optional<std::array<double, 6>> transform = {};
  std::string crs = {};  ///< any text that GDAL accepts as a CRS; empty: without a CRS
  std::optional<double> nodata = {};
  double scale = 1;
  double offset = 0;
  std::function<bool(int col, int row)> valid = {};  ///< a mask band, if set
  std::string unit = {};                             ///< unit of the elevations; empty: none
};

/// Writes a GeoTIFF; throws std::runtime_error with GDAL's reason.
void write_geotiff(const std::string& path, const TestRaster& raster);

/// The coordinates of site points in another CRS, computed by PROJ.
std::vector<MapPoint> site_to_crs(const std::string& site_wkt, const std::vector<SitePoint>& points,
                                  const std::string& crs);
MapPoint site_to_crs(const std::string& site_wkt, const SitePoint& point, const std::string& crs);

/// True if GDAL reads the text as a local CRS in metres.
bool is_local_in_metres(const std::string& wkt);

}  // namespace landfall
