// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/text/number_table.h"

namespace landfall {

/// A column that a table wants, under its wanted name, and its position among those of the file.
struct MatchedColumn {
  std::string name;
  std::size_t position;
};

/// The columns that a table wants among the names of a file. Names are compared without case. Calls `fail`
/// (which throws) for a required column that is missing, with the names that the file has and those that it
/// needs; for a wanted column that is there twice; and, where all columns are wanted, for one without a name.
[[nodiscard]] std::vector<MatchedColumn> matched_columns(const std::vector<std::string>& names,
                                                         const TableColumns& wanted,
                                                         const std::function<void(const std::string&)>& fail);

/// Whether the names contain all required ones; where all columns are wanted, at least one name.
[[nodiscard]] bool has_columns(const std::vector<std::string>& names, const TableColumns& wanted);

/// "t_s, x_m, y_m", shortened to about 200 characters of plain ASCII.
[[nodiscard]] std::string name_list(const std::vector<std::string>& names);

/// The columns that a table needs, for a message: "the columns t_s, x_m, y_m, z_m".
[[nodiscard]] std::string needed_columns(const TableColumns& wanted);

}  // namespace landfall
