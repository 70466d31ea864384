// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "base/output/output_path.h"
#include "store/hdf5/h5.h"

namespace landfall {

/// The positions of a scan's points, in the shape that all readers of XDMF accept: one dataset of N x 3
/// instead of the scan's three columns.
struct PointPositions {
  std::string scan;                    ///< path of the scan relative to the folder of the file, or absolute
  std::array<std::string, 3> columns;  ///< of its /points: x, y and z
  h5::Type type = h5::Type::float64;   ///< of `position`: float64 or float32
  std::size_t rows = 0;                ///< of every column
  std::string scan_id;                 ///< the scan's file_id
};

/// The smallest integer type that holds the row numbers 0, 1, ...
[[nodiscard]] h5::Type row_type(std::size_t rows);

/// Writes a small HDF5 file of two datasets that appears complete or not at all:
/// `/position`, N x 3, virtual (HDF5 1.10): holds no coordinates, but refers to those in the scan;
/// `/row`, N x 1 of row_type(): 0, 1, ..., the point that belongs to each vertex.
/// The file is written and flushed on return; the caller commits. Throws IoError naming the output when
/// writing fails.
void write_point_positions(OutputPath& output, const PointPositions& positions, const std::string& tool,
                           int compression);

}  // namespace landfall
