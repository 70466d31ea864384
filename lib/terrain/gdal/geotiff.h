// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "raster/grid.h"

namespace landfall {

/// One band of a GeoTIFF. The grid is not owned.
struct GeotiffBand {
  std::variant<const Grid<double>*, const Grid<float>*, const Grid<std::int32_t>*, const Grid<std::int8_t>*>
      values;  ///< NaN has no value; integers all have
  std::string unit = "m";
  std::string name = {};  ///< the band's description; may be empty
};

/// What a GeoTIFF says. Nothing but texts is owned.
struct GeotiffContent {
  std::vector<GeotiffBand> bands;  ///< at least one, all of one GridSpec
  const std::string& crs_wkt;      ///< of the site frame
  std::string software;            ///< the tag TIFFTAG_SOFTWARE
  std::string file_id;             ///< of the source: the metadata item LANDFALL_FILE_ID
};

/// How it is written; the bytes do not depend on the number of threads.
struct GeotiffOptions {
  int compression = 1;  ///< deflate level 0..9, 0 is none
  std::size_t threads = 1;
};

}  // namespace landfall
