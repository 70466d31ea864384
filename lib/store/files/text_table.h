// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "base/text/number_table.h"

namespace landfall {

/// Reads columns from text (number_table.h). Throws FormatError naming the file and the line, and what is
/// there; files of other kinds are named with what to do: UTF-16, compressed, a workbook, MATLAB before 7.3,
/// HELIOS++ and SBET trajectories.
[[nodiscard]] NumberTable read_text_table(const std::filesystem::path& path, const TableColumns& wanted);

}  // namespace landfall
