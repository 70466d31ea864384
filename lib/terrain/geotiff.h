// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "raster/grid.h"

namespace landfall {

/// What a GeoTIFF of a terrain says. Nothing is owned.
struct GeotiffContent {
  const Grid<double>& nodes;   ///< metres; NaN is a hole
  const std::string& crs_wkt;  ///< of the site frame
  std::string software;        ///< the tag TIFFTAG_SOFTWARE
  std::string file_id;         ///< of the terrain: the metadata item LANDFALL_FILE_ID
};

/// How it is written; the bytes do not depend on the number of threads.
struct GeotiffOptions {
  int compression = 1;  ///< deflate level 0..9, 0 is none
  std::size_t threads = 1;
};

}  // namespace landfall
