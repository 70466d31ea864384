// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"

namespace landfall {

/// Named columns of numbers, all of one length, from a CSV or HDF5 table.
class NumberTable {
 public:
  NumberTable() = default;
  /// `file` begins every message. Throws FormatError if the columns differ in length.
  NumberTable(std::string file, std::map<std::string, std::vector<double>> columns)
      : file_(std::move(file)), columns_(std::move(columns)) {
    for (const auto& [name, values] : columns_)
      if (values.size() != row_count())
        fail("columns " + columns_.begin()->first + " and " + name + " differ in length");
  }

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::size_t row_count() const {
    return columns_.empty() ? 0 : columns_.begin()->second.size();
  }
  [[nodiscard]] bool has(const std::string& column) const { return columns_.contains(column); }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& [name, values] : columns_) names.push_back(name);
    return names;
  }
  /// The column must exist.
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const { return columns_.at(name); }
  /// Throws FormatError "file: what".
  [[noreturn]] void fail(const std::string& what) const { throw FormatError(file_ + ": " + what); }
  /// Throws FormatError "file: row 3: what"; rows are counted from 1, after the header.
  [[noreturn]] void fail_at(std::size_t index, const std::string& what) const {
    fail("row " + std::to_string(index + 1) + ": " + what);
  }

 private:
  std::string file_;
  std::map<std::string, std::vector<double>> columns_;
};

/// The columns to read from a file. Every required column must be present; optional ones may be missing.
struct TableColumns {
  std::vector<std::string> required = {};
  std::vector<std::string> optional = {};
  bool all = false;  ///< every column of the file, by whatever name
};

/// Reads the table of a component that is defined by a file. `role` is the role of the table in the
/// provenance ("trajectory", "pattern"). Throws FormatError naming the file.
using TableLoader =
    std::function<NumberTable(const std::string& path, const std::string& role, const TableColumns& columns)>;

/// Throws FormatError "name: row 3: what"; rows are counted from 1.
[[noreturn]] inline void refuse_row(const std::string& name, std::size_t index, const std::string& what) {
  throw FormatError(name + ": row " + std::to_string(index + 1) + ": " + what);
}

/// Checks a table over time: at least 2 rows, t_s finite and strictly increasing by finite steps, `is_finite`
/// true for each row. Otherwise throws FormatError, which begins with `name`, for the first invalid row.
template <class Row, class IsFinite>
void require_timed_rows(std::span<const Row> rows, const std::string& name, const IsFinite& is_finite) {
  if (rows.size() < 2)
    throw FormatError(name + ": " + std::to_string(rows.size()) + " rows, at least 2 are needed");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!std::isfinite(rows[i].t_s) || !is_finite(rows[i])) refuse_row(name, i, "a value is not finite");
    if (i > 0 && !(rows[i].t_s > rows[i - 1].t_s))
      refuse_row(name, i, "t_s does not exceed that of the row before");
    if (i > 0 && !std::isfinite(rows[i].t_s - rows[i - 1].t_s))
      refuse_row(name, i, "the step of t_s from the row before is not a finite number");
  }
}

}  // namespace landfall
