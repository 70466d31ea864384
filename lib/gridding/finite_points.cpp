// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/finite_points.h"

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "base/error.h"

namespace landfall {
namespace {

struct Column {
  const char* name;
  std::span<const double> values;
};

std::array<Column, 7> columns(const GridPoints& p) {
  return {{{"x_est", p.x_est},
           {"y_est", p.y_est},
           {"z_est", p.z_est},
           {"x_true", p.x_true},
           {"y_true", p.y_true},
           {"z_true", p.z_true},
           {"t", p.t}}};
}

}  // namespace

void throw_first_not_finite(const GridPoints& points, std::int64_t first_row_number) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Column& column : columns(points))
      if (!std::isfinite(column.values[i]))
        throw FormatError("row " + std::to_string(first_row_number + static_cast<std::int64_t>(i)) + ": " +
                          column.name + " is " + std::to_string(column.values[i]) +
                          "; the coordinates of a return must be finite");
  throw std::logic_error("every return is finite");
}

}  // namespace landfall
