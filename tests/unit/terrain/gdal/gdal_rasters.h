// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "terrain/relief/site_mapping.h"

namespace landfall {

/// A raster to write: `value(col, row)` at each pixel, as the file stores it.
struct TestRaster {
  int cols = 0;
  int rows = 0;
  std::function<double(int col, int row)> value;
  std::string type = "Float64";  ///< GDAL's name
  std::optional<std::array<double, 6>> transform;
  std::string crs;  ///< anything GDAL understands; empty: none
  std::optional<double> nodata;
  double scale = 1;
  double offset = 0;
  std::function<bool(int col, int row)> valid;  ///< a mask band, where given
};

/// Writes a GeoTIFF; throws std::runtime_error with GDAL's reason.
void write_geotiff(const std::string& path, const TestRaster& raster);

/// Where points of the site lie in another CRS, by PROJ.
std::vector<MapPoint> site_to_crs(const std::string& site_wkt, const std::vector<SitePoint>& points,
                                  const std::string& crs);
MapPoint site_to_crs(const std::string& site_wkt, const SitePoint& point, const std::string& crs);

/// True where GDAL reads the text as a local CRS in metres.
bool is_local_in_metres(const std::string& wkt);

}  // namespace landfall
