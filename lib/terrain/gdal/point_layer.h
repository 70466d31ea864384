// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace landfall {

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
