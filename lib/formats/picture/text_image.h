// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

#include "formats/picture/rgb_image.h"

namespace landfall {

/// The height of a line of text, pixels: DejaVu Sans of 14 pixels, proportional and smoothed.
[[nodiscard]] std::int64_t text_height();

/// The advance of all letters, pixels; 0 for an empty text.
[[nodiscard]] std::int64_t text_width(std::string_view text);

/// The upper left pixel of a text.
struct TextPosition {
  std::int64_t row;
  std::int64_t column;
};

/// Draws the letters of Latin 1 in UTF-8, and '?' for anything else. The part outside the image is clipped.
void draw_text(RgbImage& image, const TextPosition& position, std::string_view text, Rgb color);

}  // namespace landfall
