// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/output/output_path.h"

namespace landfall {

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// An image. Row 0 is the top row, unlike in a grid.
struct RgbImage {
  RgbImage(std::size_t columns, std::size_t rows, Rgb fill)
      : width(columns), height(rows), pixels(columns * rows, fill) {}

  std::size_t width;
  std::size_t height;
  std::vector<Rgb> pixels;  ///< row by row

  [[nodiscard]] const Rgb& at(std::size_t row, std::size_t column) const {
    return pixels[row * width + column];
  }
  [[nodiscard]] bool holds(std::int64_t row, std::int64_t column) const {
    return row >= 0 && column >= 0 && row < static_cast<std::int64_t>(height) &&
           column < static_cast<std::int64_t>(width);
  }
  /// Does nothing outside the image.
  void set(std::int64_t row, std::int64_t column, Rgb color) {
    if (!holds(row, column)) return;
    pixels[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)] = color;
  }
};

/// Writes an image as an 8-bit RGB PNG that appears complete or not at all (output_path.h). Equal images give
/// equal bytes. Throws UsageError if the output exists, IoError, naming the output, if it cannot be written
/// or the image has no pixels. The compression level of `output` is not used.
void write_png(const OutputOptions& output, const RgbImage& image);

}  // namespace landfall
