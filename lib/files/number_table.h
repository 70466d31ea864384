// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/number_table.h"
#include "files/provenance.h"

namespace landfall {

/// Reads columns of numbers from
/// - CSV: a header line that names the columns in any order (others are ignored), then numbers; empty lines
///   and lines that begin with # are skipped;
/// - HDF5: 1-D datasets of these names and equal length at the root.
/// HDF5 is detected by its signature. Throws FormatError naming the file and the line or column.
[[nodiscard]] NumberTable read_number_table(const std::filesystem::path& path, const TableColumns& columns);

/// Reads the tables that a configuration names, and adds each to `provenance`, which must outlive the loader.
[[nodiscard]] TableLoader recording_table_loader(Provenance& provenance);

}  // namespace landfall
