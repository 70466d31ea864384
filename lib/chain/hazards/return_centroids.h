// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/raster/grid.h"

namespace landfall {

/// The mean position of the returns of each bin, metres in the frame of the grid; NaN in bins without a
/// return.
struct ReturnCentroids {
  Grid<float> x, y;
};

}  // namespace landfall
