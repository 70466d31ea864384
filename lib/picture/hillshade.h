// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "picture/pixel_map.h"

namespace landfall {

/// The shade of each pixel of a map of elevations (metres) under a light from the north-west, 45 degrees
/// high: 1 is level ground, 0 what faces away. Slopes come from the neighbours; a pixel beside one without a
/// value has that side's slope left out, one without any neighbour is level. Heights are exaggerated or
/// flattened by one factor in [1/4, 5] that brings the rms slope nearest to 0.4.
[[nodiscard]] std::vector<double> hillshade(const PixelMap& elevations);

}  // namespace landfall
