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

/// Sorts the rows of such a table, which may be in any order, into the row-major order of the pixels of a
/// rows x columns detector. Throws FormatError by the table's fail() where a row names a pixel outside the
/// detector or a pixel already named, or has a point that is not finite; and, naming the first, where a pixel
/// is missing.
[[nodiscard]] std::vector<ImagePoint> pixel_points(const NumberTable& table, int rows, int columns);

}  // namespace landfall
