// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
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
  Colors colors = Colors::magnitude;
  bool relief = false;     ///< shaded relief
  bool cut = true;         ///< outliers may lie beyond the ends of the colour bar
  bool from_zero = false;  ///< a magnitude whose scale begins at zero
  std::optional<double> limit =
      std::nullopt;  ///< lies within the scale and is marked on it, for errors also its negative
};

/// The values at the ends of the colour bar (D241). Of errors, and of magnitudes from zero: the 99.5 %
/// quantile of the magnitudes, at least 1.1 times the limit; errors are symmetric about zero. Of others: the
/// least and the greatest value of the map, or the 0.5 and 99.5 % quantiles if those lie more than twice as
/// far apart. Without `cut` the extremes. Without a value 0 and 1; the two are never equal.
[[nodiscard]] std::array<double, 2> color_range(const PixelMap& map, const MapStyle& style);

/// Round numbers, about `count` of them, within [low, high].
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// Draws the map with its title, least and greatest pixel, axes in metres and a colour bar. Small maps are
/// enlarged by an integer factor, to 600 pixels or more on the longer side.
[[nodiscard]] RgbImage map_picture(const PixelMap& map, const MapStyle& style);

}  // namespace landfall
