// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/pixel_table.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "base/text/number_text.h"

namespace landfall {
namespace {

/// The whole number in 0 .. count - 1 that a cell of `column` holds.
std::size_t whole(const NumberTable& table, const char* column, std::size_t line, int count) {
  const double value = table.column(column)[line];
  if (value >= 0 && value < count && value == std::floor(value)) return static_cast<std::size_t>(value);
  table.fail_at(line, std::string(column) + " " + number_text(value) + " is not one of 0.." +
                          std::to_string(count - 1));
}

std::string pixel_text(std::size_t pixel, std::size_t columns) {
  return "pixel (row " + std::to_string(pixel / columns) + ", column " + std::to_string(pixel % columns) +
         ")";
}

/// Calls take(pixel, line) for each row of the table.
void for_each_pixel(const NumberTable& table, int rows, int columns, const auto& take) {
  const auto width = static_cast<std::size_t>(columns);
  std::vector<bool> seen(static_cast<std::size_t>(rows) * width);
  for (std::size_t line = 0; line < table.row_count(); ++line) {
    const std::size_t pixel = whole(table, "row", line, rows) * width + whole(table, "column", line, columns);
    if (seen[pixel]) table.fail_at(line, pixel_text(pixel, width) + " has a row already");
    seen[pixel] = true;
    take(pixel, line);
  }
  for (std::size_t pixel = 0; pixel < seen.size(); ++pixel)
    if (!seen[pixel]) table.fail(pixel_text(pixel, width) + " has no row");
}

}  // namespace

const TableColumns& pixel_table_columns() {
  static const TableColumns columns{{"row", "column", "u", "v"}};
  return columns;
}

std::vector<ImagePoint> pixel_points(const NumberTable& table, int rows, int columns) {
  std::vector<ImagePoint> points(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  for_each_pixel(table, rows, columns, [&](std::size_t pixel, std::size_t line) {
    const ImagePoint point{table.column("u")[line], table.column("v")[line]};
    if (!std::isfinite(point.u) || !std::isfinite(point.v)) table.fail_at(line, "u and v must be finite");
    points[pixel] = point;
  });
  return points;
}

const TableColumns& pixel_offset_columns() {
  static const TableColumns columns{{"row", "column", "offset_m"}};
  return columns;
}

std::vector<double> pixel_offsets_m(const NumberTable& table, int rows, int columns) {
  std::vector<double> offsets_m(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  for_each_pixel(table, rows, columns, [&](std::size_t pixel, std::size_t line) {
    const double offset_m = table.column("offset_m")[line];
    if (!std::isfinite(offset_m)) table.fail_at(line, "offset_m must be finite");
    offsets_m[pixel] = offset_m;
  });
  return offsets_m;
}

}  // namespace landfall
