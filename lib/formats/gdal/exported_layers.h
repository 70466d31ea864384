// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/raster/grid.h"

namespace landfall {

/// One band of a GeoTIFF. The grid is not owned.
struct GeotiffBand {
  std::variant<const Grid<double>*, const Grid<float>*, const Grid<std::int32_t>*, const Grid<std::int8_t>*>
      values;  ///< NaN is no value; integers always are one
  std::string unit = "m";
  std::string name = {};  ///< the band's description; may be empty
};

/// The content of a GeoTIFF. Only the texts are owned.
struct GeotiffContent {
  std::vector<GeotiffBand> bands;  ///< at least one, all of one GridSpec
  const std::string& crs_wkt;      ///< of the site frame
  std::string software;            ///< the tag TIFFTAG_SOFTWARE
  std::string file_id;             ///< of the source, for the metadata item LANDFALL_FILE_ID
};

/// How the file is written. The bytes do not depend on the number of threads.
struct GeotiffOptions {
  int compression = 1;  ///< deflate level 0..9; 0: uncompressed
  std::size_t threads = 1;
};

/// Points with attributes, for a GIS.
struct PointLayer {
  struct Column {
    std::string name;
    std::vector<double> values;  ///< of each point; NaN is no value
    bool is_integer = false;
  };

  std::string name;
  std::vector<double> x_m, y_m, z_m;
  std::vector<Column> columns;
  std::string crs_wkt;  ///< of the site frame
};

}  // namespace landfall
