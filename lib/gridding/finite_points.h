// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "gridding/grid_points.h"

namespace landfall {

/// True where all coordinates of return i are finite.
[[nodiscard]] inline bool is_finite(const GridPoints& p, std::size_t i) {
  // A number that is not finite minus itself is NaN.
  const double zero = (p.x_est[i] - p.x_est[i]) + (p.y_est[i] - p.y_est[i]) + (p.z_est[i] - p.z_est[i]) +
                      (p.x_true[i] - p.x_true[i]) + (p.y_true[i] - p.y_true[i]) +
                      (p.z_true[i] - p.z_true[i]) + (p.t[i] - p.t[i]);
  return zero == 0;
}

/// Throws FormatError naming the first return that is not finite, by its row number, and its column; there
/// must be one.
[[noreturn]] void throw_first_not_finite(const GridPoints& points, std::int64_t first_row_number);

}  // namespace landfall
