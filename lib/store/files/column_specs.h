// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/returns/columns.h"
#include "store/hdf5/table.h"

namespace landfall {

/// The description of a column in the file.
template <class Table, class T>
ColumnSpec spec_of(const Column<Table, T>& column, bool single_precision) {
  if constexpr (std::is_same_v<T, PointStatus>) {
    ColumnSpec spec{column.name, h5::Type::int8, column.units, column.long_name};
    for (const PointStatusInfo& info : kPointStatuses) {
      spec.flag_values.push_back(static_cast<std::int8_t>(info.status));
      spec.flag_meanings += (spec.flag_meanings.empty() ? "" : " ") + std::string(info.meaning);
    }
    return spec;
  } else {
    const bool as_float = std::is_same_v<T, double> && single_precision;
    return {column.name, as_float ? h5::Type::float32 : h5::TypeOf<T>::value, column.units, column.long_name};
  }
}

/// The rows of a column of a table.
template <class Table, class T>
ColumnRows rows_of_column(const Column<Table, T>& column, const Table& table) {
  const std::vector<T>& rows = table.*column.rows;
  if constexpr (std::is_same_v<T, PointStatus>) {
    static_assert(sizeof(PointStatus) == 1);
    return std::span(reinterpret_cast<const std::int8_t*>(rows.data()), rows.size());
  } else {
    return std::span(rows);
  }
}

}  // namespace landfall
