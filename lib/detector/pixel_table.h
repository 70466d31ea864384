// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/number_table.h"

namespace landfall {

/// A point on the image plane, tangent units: u to the right, v up.
struct ImagePoint {
  double u = 0;
  double v = 0;
  friend bool operator==(const ImagePoint&, const ImagePoint&) = default;
};

/// The columns of a table of pixel directions: row, column, u, v.
[[nodiscard]] const TableColumns& pixel_table_columns();

/// Orders the rows of such a table, which may come in any order, as the pixels of a detector of
/// rows x columns, row-major. Throws FormatError by the table's fail() where a row names no pixel of the
/// detector, names a pixel again, or has a point that is not finite; and, naming the first, where a pixel is
/// missing.
[[nodiscard]] std::vector<ImagePoint> pixel_points(const NumberTable& table, int rows, int columns);

}  // namespace landfall
