// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "hdf5/h5.h"
#include "output/output_path.h"

namespace landfall {

/// The positions of a scan's points, in the shape that readers of XDMF share: one dataset of N x 3, where the
/// scan has three columns.
struct PointPositions {
  std::string scan;                    ///< the scan as seen from the folder of the file, or absolute
  std::array<std::string, 3> columns;  ///< of its /points: x, y and z
  h5::Type type = h5::Type::float64;   ///< of `position`: float64 or float32
  std::size_t rows = 0;                ///< of every column
  std::string scan_id;                 ///< the scan's file_id
};

/// 0, 1, ... fit in it.
[[nodiscard]] h5::Type row_type(std::size_t rows);

/// Writes a small HDF5 file of two datasets, whole or not at all:
/// `/position`, N x 3, virtual (HDF5 1.10): it holds no coordinate, but says where in the scan they are;
/// `/row`, N x 1 of row_type(): 0, 1, ..., the point that each vertex stands on.
/// It is written and flushed when this returns; the caller commits. Throws IoError naming the output when
/// writing fails.
void write_point_positions(OutputPath& output, const PointPositions& positions, const std::string& tool,
                           int compression);

}  // namespace landfall
