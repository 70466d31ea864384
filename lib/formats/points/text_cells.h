// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/characters.h"

namespace landfall {

/// How a row of text is divided into cells, and how these write numbers.
struct RowForm {
  char separator = ' ';  ///< ' ': any number of blanks and tabs
  bool has_decimal_commas = false;
};

/// Without blanks and one pair of quotes around it.
[[nodiscard]] std::string_view without_quotes(std::string_view cell);

/// The text of a comment without the characters that begin it (//, #, %); nothing for another line.
[[nodiscard]] std::optional<std::string_view> comment_of(std::string_view line);

/// A line without the blanks around it that do not divide cells.
[[nodiscard]] std::string_view row_text(std::string_view line, char separator);

/// Calls use(number of the cell, cell) for each cell of a line; returns their number. Blanks divide where the
/// separator is one; an empty last cell does not count.
template <class Use>
std::size_t for_each_cell(std::string_view line, char separator, const Use& use) {
  std::size_t count = 0;
  line = row_text(line, separator);
  while (!line.empty()) {
    std::size_t end = 0;
    if (separator == ' ')
      while (end < line.size() && !is_blank(line[end])) ++end;
    else
      end = std::min(line.find(separator), line.size());
    use(count++, line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
    if (separator == ' ') line = trimmed(line);
  }
  return count;
}

[[nodiscard]] std::vector<std::string> cells_of(std::string_view line, char separator);

/// The cells of a header: between blanks, brackets belong to the word before them ("x [mm] y [mm]").
[[nodiscard]] std::vector<std::string> names_of(std::string_view line, char separator);

/// The number that a cell writes; NaN for an empty one and for the words of missing values ("NA", "null").
[[nodiscard]] std::optional<double> cell_value(std::string_view cell, bool has_decimal_commas);

/// True for a cell that is a number, not a missing one.
[[nodiscard]] bool is_number(std::string_view cell, bool has_decimal_commas);

[[nodiscard]] std::optional<std::int64_t> whole_number(std::string_view cell);

/// The form of a row by its characters: a semicolon divides before a tab, a tab before a comma, a comma
/// before blanks. Commas next to another separator, and between digits of words that blanks divide, are those
/// of decimals.
[[nodiscard]] RowForm form_of(std::string_view row);

/// True for a line of at least three numbers, or of numbers only.
[[nodiscard]] bool is_row(std::string_view line);

}  // namespace landfall
