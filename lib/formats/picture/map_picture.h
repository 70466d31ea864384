// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/picture/color_map.h"
#include "formats/picture/pixel_map.h"
#include "formats/picture/rgb_image.h"

namespace landfall {

/// A class of pixels, which has a name and a colour instead of a number on a scale.
struct MapClass {
  std::string name;
  std::uint32_t color;  ///< 0xRRGGBB
};

/// The style and labels of a map.
struct MapStyle {
  std::string title;  ///< the layer
  std::string unit;   ///< not written if empty or "1"
  Colors colors = Colors::magnitude;
  bool relief = false;                         ///< shaded relief
  bool cut = true;                             ///< outliers may lie beyond the ends of the colour bar
  bool from_zero = false;                      ///< a magnitude whose scale begins at zero
  std::optional<double> limit = std::nullopt;  ///< where it is near, lies within the scale and is marked on
                                               ///< it, for errors also its negative
  /// If there are any, the map's values are their indices, and a legend replaces the colour bar.
  std::vector<MapClass> classes = {};
};

/// The values at the ends of the colour bar (D241). Of errors, and of magnitudes from zero: the 99.5 %
/// quantile of the magnitudes, and at least 1.1 times a limit that is near; errors are symmetric about zero.
/// Of others: the least and the greatest value of the map, or the 0.5 and 99.5 % quantiles if those lie more
/// than twice as far apart. Without `cut` the extremes. Without a value 0 and 1; the two are never equal.
[[nodiscard]] std::array<double, 2> color_range(const PixelMap& map, const MapStyle& style);

/// Round numbers, about `count` of them, within [low, high].
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// Draws the map with its title, least and greatest pixel (of classes: the size of a pixel), axes in metres
/// and a colour bar or legend. Small maps are enlarged by an integer factor, to 600 pixels or more on the
/// longer side.
[[nodiscard]] RgbImage map_picture(const PixelMap& map, const MapStyle& style);

}  // namespace landfall
