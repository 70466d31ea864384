// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/raster/polygon.h"

namespace landfall {

struct PolygonFileRequest {
  std::string path;
  std::string layer;        ///< of the file; empty: its only one
  std::string site_wkt;     ///< the CRS of the DEM's frame
  bool same_frame = false;  ///< coordinates are x and y of that frame whatever the file's CRS is
};

/// Polygons in x and y of the DEM frame.
struct PolygonFile {
  std::vector<Polygon> polygons;
  std::vector<std::string> assumed{};  ///< sentences without the file's name
};

/// polygon_file() of gdal_loader.h.
[[nodiscard]] PolygonFile read_polygons(const PolygonFileRequest& request);

}  // namespace landfall
