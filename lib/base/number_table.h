// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

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

}  // namespace landfall
