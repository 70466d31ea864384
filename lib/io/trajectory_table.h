// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "trajectory/table_trajectory.h"

namespace landfall {

/// Reads t_s, x_m, y_m, z_m, qw, qx, qy, qz (quaternion scalar-first, D <- B) from
/// - CSV: a header line that names the columns in any order (others are ignored), then numbers; empty lines
/// and lines that
///   begin with # are skipped;
/// - HDF5: 1-D datasets of these names and equal length at the root.
/// HDF5 is told by its signature. Throws FormatError naming the file and the line or column.
[[nodiscard]] std::vector<TrajectorySample> read_trajectory_table(const std::filesystem::path& path);

}  // namespace landfall
