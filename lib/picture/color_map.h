// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "raster/rgb_image.h"

namespace landfall {

/// The quantities that maps show. Each has one colour map, the same in pictures, reports and figures (D240).
enum class Colors {
  elevation,  ///< cividis (Nunez, Anderton, Renslow, PLOS ONE 2018), shaded
  error,      ///< blue, white, red (ColorBrewer RdBu), symmetric: zero is white
  count,      ///< ColorBrewer YlOrBr: returns, frames
  magnitude,  ///< viridis (van der Walt, Smith 2015): relative errors, sigmas, and everything else
};
inline constexpr std::size_t kColorMaps = 4;

/// "elevation", "error", "count", "magnitude".
[[nodiscard]] const char* name_of(Colors colors);
/// The colours 0xRRGGBB at equal distances from 0 to 1; colours between are interpolated.
[[nodiscard]] std::span<const std::uint32_t> color_anchors(Colors colors);
[[nodiscard]] Rgb rgb_of(std::uint32_t rrggbb);
/// The colour of a fraction in [0, 1]; a fraction outside gets the colour of the nearer end.
[[nodiscard]] Rgb color_of(double fraction, Colors colors);

inline constexpr std::uint32_t kNoValueColor = 0xc8c8c8;  ///< unlike any colour of the maps
inline constexpr std::uint32_t kMarkColor = 0xff00ff;     ///< bins that stand out from every map

/// The classes of places to land on; missed hazards have kMarkColor.
inline constexpr std::uint32_t kSafeColor = 0xcfe4f2;
inline constexpr std::uint32_t kHazardColor = 0xe69f00;
inline constexpr std::uint32_t kFalseAlarmColor = 0x0072b2;
inline constexpr std::uint32_t kUnknownColor = 0x8c8c8c;

}  // namespace landfall
