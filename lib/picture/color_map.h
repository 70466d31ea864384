// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "raster/rgb_image.h"

namespace landfall {

enum class Colors {
  sequential,  ///< cividis (Nunez, Anderton, Renslow, PLOS ONE 2018): blue to yellow, made for colour
               ///< blindness
  diverging,   ///< blue, white, red (ColorBrewer RdBu): 0.5 is white
};

/// The colour of a fraction in [0, 1]; a fraction outside gets the colour of the nearer end.
[[nodiscard]] Rgb color_of(double fraction, Colors colors);
/// The colour of a missing value, unlike any colour of the map.
[[nodiscard]] Rgb no_value_color(Colors colors);

}  // namespace landfall
