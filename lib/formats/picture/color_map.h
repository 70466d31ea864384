// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/dictionary/tables/maps.h"
#include "formats/picture/rgb_image.h"

namespace landfall {

/// The quantities that maps show. Each has one colour map, the same in pictures, reports and figures (D240),
/// in schemas/dictionary/maps.json: elevation (shaded), error (symmetric: zero is white), count (returns,
/// frames) and magnitude (relative errors, sigmas, and everything else).
enum class Colors {
#define LANDFALL_COLORS_OF(name) name,
  LANDFALL_COLOR_MAPS(LANDFALL_COLORS_OF)
#undef LANDFALL_COLORS_OF
};
inline constexpr std::size_t kColorMaps = dictionary::kColorMaps.size();

/// "elevation", "error", "count", "magnitude".
[[nodiscard]] const char* name_of(Colors colors);
/// The colours 0xRRGGBB at equal distances from 0 to 1; colours between are interpolated.
[[nodiscard]] std::span<const std::uint32_t> color_anchors(Colors colors);
[[nodiscard]] Rgb rgb_of(std::uint32_t rrggbb);
/// The colour of a fraction in [0, 1]; a fraction outside gets the colour of the nearer end.
[[nodiscard]] Rgb color_of(double fraction, Colors colors);

/// A colour of schemas/dictionary/maps.json by its name.
[[nodiscard]] constexpr std::uint32_t color_named(std::string_view name) {
  return std::ranges::find(dictionary::kColors, name, &dictionary::Color::name)->color;
}

inline constexpr std::uint32_t kNoValueColor = color_named("no_value");  ///< unlike any colour of the maps
inline constexpr std::uint32_t kMarkColor = color_named("mark");  ///< bins that stand out from every map

}  // namespace landfall
