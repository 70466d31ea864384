// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/text/number_table.h"

namespace landfall {

/// A point on the image plane, tangent units: u to the right, v up.
struct ImagePoint {
  double u = 0;
  double v = 0;
  friend bool operator==(const ImagePoint&, const ImagePoint&) = default;
};

// Tables of one row per pixel, in any order, for a rows x columns detector; results are in the row-major
// order of the pixels. FormatError by the table's fail() where a row names a pixel outside the detector or a
// pixel already named, or has a value that is not finite; and, naming the first, where a pixel is missing.

/// Pixel directions: columns row, column, u, v.
[[nodiscard]] const TableColumns& pixel_table_columns();
[[nodiscard]] std::vector<ImagePoint> pixel_points(const NumberTable& table, int rows, int columns);

/// Range offsets, metres: columns row, column, offset_m.
[[nodiscard]] const TableColumns& pixel_offset_columns();
[[nodiscard]] std::vector<double> pixel_offsets_m(const NumberTable& table, int rows, int columns);

}  // namespace landfall
