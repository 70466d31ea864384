// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "base/raster/grid.h"

namespace landfall {

/// A terrain that is only partly in memory.
struct LargeTerrain {
  GridSpec spec;
  double lowest_m = 0;  ///< bounds of all elevations
  double highest_m = 0;
  BinIndex tile{256, 256};  ///< windows begin and end at multiples of it, or end with the terrain

  /// Loads the nodes of a window. One call at a time, from any thread.
  std::function<Grid<double>(const GridSpec& window)> load;
};

}  // namespace landfall
