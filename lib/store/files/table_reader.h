// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/text/number_table.h"
#include "store/files/provenance.h"

namespace landfall {

/// Reads columns of numbers from
/// - text: a header line that names the columns in any order (others are ignored), then a line of numbers for
///   each row, separated by "," ";" tab or blanks. Cells may be quoted. Empty lines and lines that begin with
///   # or % are skipped; without a header line, the last such line before the numbers that names the columns
///   is the header;
/// - HDF5: datasets of these names, of the shape (N), (N, 1) or (1, N) and of equal length: those of the
///   root, or of the only group that has all required ones.
/// Names are compared without case; the table has those that are wanted, or else lower case. HDF5 is detected
/// by its signature. Throws FormatError naming the file and the line or column, what is there and what is
/// wanted.
[[nodiscard]] NumberTable read_number_table(const std::filesystem::path& path, const TableColumns& columns);

/// Reads the tables that a configuration names, and adds each to `provenance`, which must outlive the loader.
[[nodiscard]] TableLoader recording_table_loader(Provenance& provenance);

}  // namespace landfall
