// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "picture/pixel_map.h"

namespace landfall {

/// The shade of each pixel of an elevation map (metres) under light from the north-west, 45 degrees high: 1
/// for level ground, 0 for slopes facing away. Slopes come from the neighbours: a side without a value is
/// ignored, and a pixel without any neighbour is level. Heights are scaled by one factor in [1/4, 5] that
/// brings the rms slope nearest to 0.4.
[[nodiscard]] std::vector<double> hillshade(const PixelMap& elevations);

}  // namespace landfall
