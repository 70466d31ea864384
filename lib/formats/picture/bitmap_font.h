// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

#include "formats/picture/rgb_image.h"

namespace landfall {

/// A glyph is 5 x 8 dots, the last row below the base line; letters begin 6 dots apart. A dot is kDot x kDot
/// pixels.
inline constexpr std::int64_t kDot = 2;
inline constexpr std::int64_t kTextHeight = 8 * kDot;

/// Pixels from the first to the last dot; 0 for an empty text.
[[nodiscard]] std::int64_t text_width(std::string_view text);

/// The upper left pixel of a text.
struct TextPosition {
  std::int64_t row;
  std::int64_t column;
};

/// Draws ASCII 32 to 126, and '?' for anything else. The part outside the image is clipped.
void draw_text(RgbImage& image, const TextPosition& position, std::string_view text, Rgb color);

}  // namespace landfall
