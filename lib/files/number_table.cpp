// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/number_table.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/abbreviated.h"
#include "base/error.h"
#include "base/regular_file.h"
#include "hdf5/dataset_list.h"
#include "hdf5/table.h"

namespace landfall {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// Reads a CSV line by line; every message names file and line.
class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& path) : name_(path.string()), stream_(path) {
    if (!stream_) fail("cannot be read");
  }

  NumberTable read(const TableColumns& wanted) {
    std::string line;
    if (!next(line)) fail(stream_.bad() ? "reading failed" : "is empty");
    read_header(line, wanted);
    while (next(line)) read_row(line);
    if (stream_.bad()) fail("reading failed");
    std::map<std::string, std::vector<double>> columns;
    for (Column& column : columns_) columns[column.name] = std::move(column.values);
    return {name_, std::move(columns)};
  }

 private:
  struct Column {
    std::string name;
    std::size_t position;  ///< in a line
    std::vector<double> values;
  };

  bool next(std::string& line) {
    while (std::getline(stream_, line)) {
      ++line_number_;
      const std::string_view text = trimmed(line);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }

  void read_header(std::string_view line, const TableColumns& wanted) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some spreadsheets begin UTF-8 with it
    if (line.substr(0, 3) == kByteOrderMark) line.remove_prefix(3);
    const auto names = cells_of(line);
    width_ = names.size();
    for (const std::string& name : wanted.required)
      if (!take_column(names, name)) fail("the header has no column " + name);
    for (const std::string& name : wanted.optional) take_column(names, name);
    if (!wanted.all) return;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string name(names[i]);
      if (name.empty()) fail("column " + std::to_string(i + 1) + " has no name");
      if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
          names.begin() + static_cast<std::ptrdiff_t>(i))
        fail("column " + shown_word(names[i]) + " is given twice");
      columns_.push_back({name, i, {}});
    }
  }

  bool take_column(const std::vector<std::string_view>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return false;
    columns_.push_back({name, static_cast<std::size_t>(found - names.begin()), {}});
    return true;
  }

  void read_row(const std::string& line) {
    const auto cells = cells_of(line);
    if (cells.size() != width_)
      fail(std::to_string(cells.size()) + " values; the header names " + std::to_string(width_));
    for (Column& column : columns_) {
      const std::string_view cell = cells[column.position];
      double value = 0;
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error != std::errc() || stop != cell.data() + cell.size())
        fail(column.name + " '" + shown_word(cell) + "' is not a number");
      column.values.push_back(value);
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(name_ + (line_number_ > 0 ? ": line " + std::to_string(line_number_) : "") + ": " +
                      what);
  }

  std::string name_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  std::vector<Column> columns_;
  std::size_t width_ = 0;
};

NumberTable read_hdf5(const std::filesystem::path& path, const TableColumns& wanted) {
  const h5::Handle file = h5::open_file(path);
  const TableReader table(file.get(), "/", path.string());
  std::map<std::string, std::vector<double>> columns;
  const auto read = [&](const std::string& name) {
    std::vector<double>& values = columns[name];
    values.resize(table.row_count(name));
    table.read(name, 0, std::span(values));
  };
  for (const std::string& name : wanted.required) read(name);
  for (const std::string& name : wanted.optional)
    if (table.has(name)) read(name);
  if (wanted.all)
    for (const DatasetEntry& dataset : list_datasets(file.get())) read(dataset.name);
  return {path.string(), std::move(columns)};
}

}  // namespace

NumberTable read_number_table(const std::filesystem::path& path, const TableColumns& columns) {
  require_regular_file(path);
  h5::initialise();
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 < 0) throw FormatError(path.string() + ": reading failed: " + h5::reading_failure());
  return is_hdf5 > 0 ? read_hdf5(path, columns) : CsvReader(path).read(columns);
}

TableLoader recording_table_loader(Provenance& provenance) {
  return [&provenance](const std::string& path, const std::string& role, const TableColumns& columns) {
    provenance.add_input(role, content_id(path), nlohmann::json::array());
    return read_number_table(path, columns);
  };
}

}  // namespace landfall
