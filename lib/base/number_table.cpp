// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/number_table.h"

#include <utility>

namespace landfall {

NumberTable::NumberTable(std::string file, std::map<std::string, std::vector<double>> columns)
    : file_(std::move(file)), columns_(std::move(columns)) {
  for (const auto& [name, values] : columns_)
    if (values.size() != row_count())
      fail("columns " + columns_.begin()->first + " and " + name + " differ in length");
}

}  // namespace landfall
