// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "raster/grid.h"

namespace landfall {

/// A terrain of which only a part can be in memory.
struct LargeTerrain {
  GridSpec spec;
  double lowest_m = 0;  ///< bounds of all elevations
  double highest_m = 0;
  BinIndex tile{256, 256};  ///< windows begin at multiples of it, and end there or with the terrain

  /// Loads the nodes of a window. One call at a time, from any thread.
  std::function<Grid<double>(const GridSpec& window)> load;
};

}  // namespace landfall
