// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/trajectory_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/table.h"

namespace landfall {
namespace {

constexpr std::array<const char*, 8> kColumns = {"t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};
using Row = std::array<double, kColumns.size()>;

TrajectorySample sample_of(const Row& r) {
  return {r[0], Point<DemFrame>{{r[1], r[2], r[3]}}, Eigen::Quaterniond(r[4], r[5], r[6], r[7])};
}

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

  std::vector<TrajectorySample> read() {
    std::string line;
    if (!next(line)) fail("is empty");
    read_header(line);
    std::vector<TrajectorySample> samples;
    while (next(line)) samples.push_back(sample_of(row_of(line)));
    if (stream_.bad()) fail("reading failed");
    return samples;
  }

 private:
  bool next(std::string& line) {
    while (std::getline(stream_, line)) {
      ++line_number_;
      const std::string_view text = trimmed(line);
      if (!text.empty() && text.front() != '#') return true;
    }
    return false;
  }

  void read_header(std::string_view line) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some spreadsheets begin UTF-8 with it
    if (line.substr(0, 3) == kByteOrderMark) line.remove_prefix(3);
    const auto names = cells_of(line);
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const auto found = std::find(names.begin(), names.end(), kColumns[i]);
      if (found == names.end()) fail("the header has no column " + std::string(kColumns[i]));
      position_[i] = static_cast<std::size_t>(found - names.begin());
    }
    width_ = names.size();
  }

  Row row_of(const std::string& line) const {
    const auto cells = cells_of(line);
    if (cells.size() != width_)
      fail(std::to_string(cells.size()) + " values; the header names " + std::to_string(width_));
    Row row{};
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      const std::string_view cell = cells[position_[i]];
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row[i]);
      if (error != std::errc() || stop != cell.data() + cell.size())
        fail(std::string(kColumns[i]) + " '" + std::string(cell) + "' is not a number");
    }
    return row;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(name_ + (line_number_ > 0 ? ": line " + std::to_string(line_number_) : "") + ": " +
                      what);
  }

  std::string name_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  std::array<std::size_t, kColumns.size()> position_{};
  std::size_t width_ = 0;
};

std::vector<TrajectorySample> read_hdf5(const std::filesystem::path& path) {
  const h5::Handle file = h5::open_file(path);
  const TableReader table(file.get(), "/", path.string());
  const std::size_t rows = table.row_count(kColumns[0]);
  std::array<std::vector<double>, kColumns.size()> columns;
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    if (table.row_count(kColumns[i]) != rows)
      throw FormatError(path.string() + ": columns t_s and " + kColumns[i] + " differ in length");
    columns[i].resize(rows);
    table.read(kColumns[i], 0, std::span(columns[i]));
  }
  std::vector<TrajectorySample> samples(rows);
  for (std::size_t r = 0; r < rows; ++r) {
    Row row{};
    for (std::size_t i = 0; i < kColumns.size(); ++i) row[i] = columns[i][r];
    samples[r] = sample_of(row);
  }
  return samples;
}

}  // namespace

std::vector<TrajectorySample> read_trajectory_table(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw FormatError(path.string() + ": no such file");
  if (std::filesystem::is_directory(path, error)) throw FormatError(path.string() + ": is a directory");
  h5::initialise();
  return H5Fis_hdf5(path.c_str()) > 0 ? read_hdf5(path) : CsvReader(path).read();
}

}  // namespace landfall
