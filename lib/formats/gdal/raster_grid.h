// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/raster/grid.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/relief/site_mapping.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// A raster whose pixels are the bins of a grid in the site frame: square and north up.
struct RasterGrid {
  GridSpec spec;         ///< the bin (0, 0) of the site is the pixel that is the origin
  PixelPosition origin;  ///< that pixel
  MapPoint center;       ///< its centre, units of the raster's CRS
  DemBase dem;           ///< the raster with `center_pixel`, read without interpolation and with its own zero
  std::string crs_name;  ///< empty: none
  bool same_frame = false;  ///< coordinates of another raster are those of this one whatever its CRS is
  std::vector<std::string> assumed{};  ///< sentences without the raster's name
};

/// Another raster at the bins of a grid.
struct SampledRaster {
  Grid<double> z;               ///< metres; NaN off the raster and in its holes
  std::string source_id;        ///< a hash of its samples and georeference
  bool is_reprojected = false;  ///< its CRS is another one: GDAL transformed the bins' centres
  std::string crs_wkt{};        ///< the frame of a site in its middle (chain/terrain/site_wkt.h)
  std::vector<std::string> assumed{};
};

}  // namespace landfall
