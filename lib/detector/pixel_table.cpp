// SPDX-License-Identifier: GPL-3.0-or-later
#include "detector/pixel_table.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "base/number_text.h"

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

}  // namespace

const TableColumns& pixel_table_columns() {
  static const TableColumns columns{{"row", "column", "u", "v"}};
  return columns;
}

std::vector<ImagePoint> pixel_points(const NumberTable& table, int rows, int columns) {
  const auto width = static_cast<std::size_t>(columns);
  std::vector<ImagePoint> points(static_cast<std::size_t>(rows) * width);
  std::vector<bool> seen(points.size());
  for (std::size_t line = 0; line < table.row_count(); ++line) {
    const std::size_t pixel = whole(table, "row", line, rows) * width + whole(table, "column", line, columns);
    const ImagePoint point{table.column("u")[line], table.column("v")[line]};
    if (seen[pixel]) table.fail_at(line, pixel_text(pixel, width) + " has a row already");
    if (!std::isfinite(point.u) || !std::isfinite(point.v)) table.fail_at(line, "u and v must be finite");
    seen[pixel] = true;
    points[pixel] = point;
  }
  for (std::size_t pixel = 0; pixel < seen.size(); ++pixel)
    if (!seen[pixel]) table.fail(pixel_text(pixel, width) + " has no row");
  return points;
}

}  // namespace landfall
