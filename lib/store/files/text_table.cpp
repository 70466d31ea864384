// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of numbers come from spreadsheets, MATLAB, numpy, C and Fortran. Their separators, quotes,
// capitals, signs, exponents and commented headers are unambiguous and are read. What two programs read
// differently is refused with a remedy: decimal commas, a wanted column that is there twice, two groups
// with the same columns.
//
// HELIOS++ and SBET trajectories are refused by name. A HELIOS++ file does not state the rotation order
// and the direction of its yaw; an SBET has geodetic coordinates, whose site frame landfall cannot know.
// Both need a conversion by their owner.
#include "store/files/text_table.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/text/characters.h"
#include "base/text/file_path.h"
#include "base/text/foreign_content.h"
#include "base/text/parsed_number.h"
#include "base/text/shown_text.h"
#include "store/files/table_columns.h"

namespace landfall {
namespace {

/// The character of "," ";" and tab that divides a line into most cells; a blank if it has none of them.
/// Characters between double quotes do not count.
char separator_of(std::string_view line) {
  char separator = ' ';
  std::ptrdiff_t maximum = 0;
  for (const char candidate : {';', '\t', ','}) {
    bool quoted = false;
    const auto count = std::ranges::count_if(line, [&](char c) {
      quoted ^= c == '"';
      return c == candidate && !quoted;
    });
    if (count > maximum) {
      separator = candidate;
      maximum = count;
    }
  }
  return separator;
}

/// A cell without blanks around it and without quotes around that.
std::string cell_text(std::string_view cell) {
  cell = trimmed(cell);
  const bool has_quotes =
      cell.size() > 1 && (cell.front() == '"' || cell.front() == '\'') && cell.back() == cell.front();
  return std::string(has_quotes ? trimmed(cell.substr(1, cell.size() - 2)) : cell);
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  if (separator == ' ') line = trimmed(line);
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    quoted ^= line[i] == '"';
    const bool ends = separator == ' ' ? is_blank(line[i]) : line[i] == separator;
    if (quoted || !ends) continue;
    if (separator != ' ' || i > begin) cells.push_back(cell_text(line.substr(begin, i - begin)));
    begin = i + 1;
  }
  cells.push_back(cell_text(line.substr(begin)));
  return cells;
}

bool is_number(std::string_view cell) {
  return parsed_number(cell).outcome != ParsedNumber::Outcome::not_a_number;
}

/// "1,5".
bool has_decimal_comma(std::string cell) {
  std::ranges::replace(cell, ',', '.');
  return std::ranges::count(cell, '.') == 1 && is_number(cell);
}

/// The line of a comment without the characters that make it one; empty if it is none.
std::optional<std::string_view> comment_of(std::string_view line) {
  line = trimmed(line);
  if (line.empty() || (line.front() != '#' && line.front() != '%')) return std::nullopt;
  return trimmed(line.substr(std::min(line.find_first_not_of("#%"), line.size())));
}

/// Reads a text line by line; every message names file and line.
class TextTable {
 public:
  TextTable(const std::filesystem::path& path, const TableColumns& wanted)
      : name_(path.string()), extension_(file_extension(path)), wanted_(wanted) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) fail("cannot be read");
    std::ostringstream content;
    content << stream.rdbuf();
    if (stream.bad() || content.bad()) fail("reading failed");
    text_ = std::move(content).str();
    require_text();
    rest_ = without_byte_order_mark(text_);
  }

  NumberTable read() {
    const std::string_view first = first_line();
    const std::vector<std::string> cells = cells_of(first, separator_of(first));
    if (is_number(cells.front())) {
      read_header(header_among_comments(cells.size(), cells.front()), line_number_);
      separator_ = separator_of(first);
      read_row(first);
    } else {
      read_header(first, line_number_);
    }
    while (const auto line = next())
      if (!trimmed(*line).empty() && !comment_of(*line)) read_row(*line);
    std::map<std::string, std::vector<double>> columns;
    for (std::size_t c = 0; c < columns_.size(); ++c) columns[columns_[c].name] = std::move(values_[c]);
    return {name_, std::move(columns)};
  }

 private:
  struct Comment {
    std::string_view text;
    std::size_t line;
  };

  /// Refuses files that are certainly not text. An SBET file (smoothed best estimate of trajectory) has
  /// records of 17 float64 and no header.
  void require_text() const {
    constexpr std::size_t kSbetRecord = 136;
    if (const std::string foreign = foreign_content(text_); !foreign.empty()) fail(foreign);
    if (text_.substr(0, 8) == "TSCANTRJ") fail("is a TerraScan trajectory; it needs " + wish());
    if (text_.find('\0') == std::string::npos) return;
    if (text_.size() % kSbetRecord == 0)
      fail("is binary, like an SBET trajectory (.out: latitude, longitude, heading in radians); it needs " +
           wish());
    fail("is binary, but not HDF5; it needs " + wish());
  }

  [[nodiscard]] std::string wish() const {
    return "text or HDF5 with " + needed_columns(wanted_) + ", in the units of their names";
  }

  /// The next line without its end (LF, CR LF or CR).
  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    ++line_number_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + (rest_.substr(end, 2) == "\r\n" ? 2 : 1), rest_.size()));
    return line;
  }

  /// The first line that is neither empty nor a comment; keeps the comments before it.
  std::string_view first_line() {
    while (const auto line = next()) {
      const auto comment = comment_of(*line);
      if (comment && comment->substr(0, 7) == "HEADER:") refuse_helios();
      if (comment)
        comments_.push_back({*comment, line_number_});
      else if (!trimmed(*line).empty())
        return *line;
    }
    fail(comments_.empty() ? "is empty" : "has comments only, no header and no row");
  }

  [[noreturn]] void refuse_helios() const {
    fail("is a HELIOS++ trajectory (.trj, #HEADER:), whose angles have other conventions; it needs " +
         wish());
  }

  /// The last comment that names the columns: numpy.savetxt writes the header as one.
  std::string_view header_among_comments(std::size_t width, const std::string& first_cell) {
    for (auto comment = comments_.rbegin(); comment != comments_.rend(); ++comment) {
      const std::vector<std::string> names = cells_of(comment->text, separator_of(comment->text));
      if (names.size() == width && has_columns(names, wanted_)) return comment->text;
    }
    if (extension_ == ".trj") refuse_helios();
    fail("begins with the number " + shown_word(first_cell) + "; its first line must name " +
         needed_columns(wanted_));
  }

  void read_header(std::string_view line, std::size_t number) {
    separator_ = separator_of(line);
    const std::vector<std::string> names = cells_of(line, separator_);
    width_ = names.size();
    columns_ = matched_columns(names, wanted_, [&](const std::string& what) {
      line_number_ = number;
      if (extension_ == ".trj" && !has_columns(names, wanted_)) refuse_helios();
      fail("the header: " + what);
    });
    values_.resize(columns_.size());
  }

  void read_row(std::string_view line) {
    const std::vector<std::string> cells = cells_of(line, separator_);
    if (cells.size() != width_)
      fail(std::to_string(cells.size()) + " values; the header names " + std::to_string(width_) +
           (cells.size() == 2 * width_ && separator_ == ',' ? "; write decimals with a point, not a comma"
                                                            : ""));
    for (std::size_t c = 0; c < columns_.size(); ++c)
      values_[c].push_back(value_of(cells[columns_[c].position], columns_[c].name));
  }

  [[nodiscard]] double value_of(const std::string& cell, const std::string& column) const {
    using enum ParsedNumber::Outcome;
    const ParsedNumber parsed = parsed_number(cell);
    if (parsed.outcome == number) return parsed.value;
    const std::string what = plain_ascii(abbreviated(column)) + " '" + shown_word(cell) + "'";
    if (parsed.outcome == too_large) fail(what + " is beyond double precision");
    fail(what + " is not a number" +
         (has_decimal_comma(cell) ? ": write decimals with a point, not a comma" : ""));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(name_ + (line_number_ > 0 ? ": line " + std::to_string(line_number_) : "") + ": " +
                      what);
  }

  std::string name_;
  std::string extension_;
  const TableColumns& wanted_;
  std::string text_;
  std::string_view rest_;
  std::size_t line_number_ = 0;
  std::vector<Comment> comments_;
  std::vector<MatchedColumn> columns_;
  std::vector<std::vector<double>> values_;
  std::size_t width_ = 0;
  char separator_ = ',';
};

}  // namespace

NumberTable read_text_table(const std::filesystem::path& path, const TableColumns& wanted) {
  return TextTable(path, wanted).read();
}

}  // namespace landfall
