// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "picture/color_map.h"
#include "picture/pixel_map.h"
#include "raster/rgb_image.h"

namespace landfall {

/// How a map is drawn and named.
struct MapStyle {
  std::string title;  ///< the layer
  std::string unit;   ///< empty or "1": none is written
  Colors colors = Colors::sequential;
  bool relief = false;  ///< shaded as ground
  bool cut = true;      ///< outliers may lie beyond the ends of the colours
};

/// The values at the ends of the colours: the least and the greatest of the map or, where these may be cut
/// and lie more than twice as far apart, its 0.5 and 99.5 % quantiles; of diverging colours the same on both
/// sides of zero. Without a value 0 and 1, and never equal.
[[nodiscard]] std::array<double, 2> color_range(const PixelMap& map, const MapStyle& style);

/// Round numbers, about `count` of them, within [low, high].
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// The map with its title, least and greatest pixel, axes in metres and a bar of its colours. Small maps are
/// enlarged by a whole factor, to 600 pixels or more on the longer side.
[[nodiscard]] RgbImage map_picture(const PixelMap& map, const MapStyle& style);

}  // namespace landfall
