// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/picture/text_image.h"

#include <cstddef>

#include "formats/picture/glyphs.h"

namespace landfall {
namespace {

/// A letter: its place in the tables of the font.
std::size_t next_letter(std::string_view& text) {
  const auto first = static_cast<unsigned char>(text.front());
  unsigned code = first;
  std::size_t bytes = 1;
  if (first >= 0x80) {
    while (bytes < text.size() && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80) ++bytes;
    const bool is_latin = (first == 0xC2 || first == 0xC3) && bytes == 2;
    code = is_latin ? (first & 3U) << 6U | (static_cast<unsigned char>(text[1]) & 0x3FU) : '?';
  }
  text.remove_prefix(bytes);
  return (code < font::kFirstLetter ? '?' : code) - font::kFirstLetter;
}

std::int64_t box_width(std::size_t letter) { return font::kAdvances[letter] + 2 * font::kLetterMargin; }

/// The index in kCoverage at which the box of a letter begins.
std::size_t box_begin(std::size_t letter) {
  std::size_t columns = 0;
  for (std::size_t before = 0; before < letter; ++before)
    columns += static_cast<std::size_t>(box_width(before));
  return columns * font::kLetterHeight;
}

Rgb mixed(Rgb paper, Rgb ink, unsigned coverage) {
  const auto part = [coverage](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>((a * (255 - coverage) + b * coverage + 127) / 255);
  };
  return {part(paper.r, ink.r), part(paper.g, ink.g), part(paper.b, ink.b)};
}

void draw_letter(RgbImage& image, const TextPosition& position, std::size_t letter, Rgb color) {
  const std::size_t begin = box_begin(letter);
  const std::int64_t width = box_width(letter);
  for (std::int64_t r = 0; r < font::kLetterHeight; ++r)
    for (std::int64_t c = 0; c < width; ++c) {
      const unsigned coverage = font::kCoverage[begin + static_cast<std::size_t>(r * width + c)];
      const std::int64_t row = position.row + r;
      const std::int64_t column = position.column + c - font::kLetterMargin;
      if (coverage == 0 || !image.holds(row, column)) continue;
      const Rgb paper = image.at(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
      image.set(row, column, mixed(paper, color, coverage));
    }
}

}  // namespace

std::int64_t text_height() { return font::kLetterHeight; }

std::int64_t text_width(std::string_view text) {
  std::int64_t width = 0;
  while (!text.empty()) width += font::kAdvances[next_letter(text)];
  return width;
}

void draw_text(RgbImage& image, const TextPosition& position, std::string_view text, Rgb color) {
  std::int64_t left = position.column;
  while (!text.empty()) {
    const std::size_t letter = next_letter(text);
    draw_letter(image, {position.row, left}, letter, color);
    left += font::kAdvances[letter];
  }
}

}  // namespace landfall
