// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "picture/color_map.h"
#include "picture/pixel_map.h"
#include "raster/rgb_image.h"

namespace landfall {

/// The style and labels of a map.
struct MapStyle {
  std::string title;  ///< the layer
  std::string unit;   ///< not written if empty or "1"
  Colors colors = Colors::sequential;
  bool relief = false;  ///< shaded relief
  bool cut = true;      ///< outliers may lie beyond the ends of the colour bar
};

/// The values at the ends of the colour bar: the least and the greatest of the map. If outliers may be cut
/// and these lie more than twice as far apart as the 0.5 and 99.5 % quantiles, the quantiles. Diverging
/// colours are symmetric about zero. Without a value 0 and 1; the two are never equal.
[[nodiscard]] std::array<double, 2> color_range(const PixelMap& map, const MapStyle& style);

/// Round numbers, about `count` of them, within [low, high].
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// Draws the map with its title, least and greatest pixel, axes in metres and a colour bar. Small maps are
/// enlarged by an integer factor, to 600 pixels or more on the longer side.
[[nodiscard]] RgbImage map_picture(const PixelMap& map, const MapStyle& style);

}  // namespace landfall
