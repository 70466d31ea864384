// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/text_cells.h"

#include <array>
#include <limits>

#include "base/text/characters.h"
#include "base/text/parsed_number.h"
#include "base/text/split_text.h"

namespace landfall {
namespace {

bool is_missing(std::string_view cell) {
  constexpr std::array<std::string_view, 6> kWords = {"na", "n/a", "#n/a", "null", "none", "nil"};
  return cell.empty() ||
         (cell.size() < 5 && std::ranges::find(kWords, lower_case(std::string(cell))) != kWords.end());
}

/// The number in a cell that is trimmed and not quoted.
ParsedNumber number_in(std::string_view cell, bool has_decimal_commas) {
  if (!has_decimal_commas) return parsed_number(cell);
  if (cell.find('.') != std::string_view::npos) return {};
  if (cell.find(',') == std::string_view::npos) return parsed_number(cell);
  std::string with_point(cell);
  with_point[cell.find(',')] = '.';
  return parsed_number(with_point);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "1,5": one comma, digits around it.
bool is_decimal_comma(std::string_view word) {
  const std::size_t comma = word.find(',');
  return comma != std::string_view::npos && comma > 0 && comma + 1 < word.size() &&
         word.find(',', comma + 1) == std::string_view::npos && is_digit(word[comma - 1]) &&
         is_digit(word[comma + 1]) && number_in(word, true).outcome == ParsedNumber::Outcome::number;
}

/// "1,5 2,5 3": numbers between blanks, some with a decimal comma, none with a point, of which a comma as
/// separator would leave less than three numbers.
bool has_decimals_between_blanks(std::string_view row) {
  const std::vector<std::string> words = cells_of(row, ' ');
  if (words.size() < 3 || row.find('.') != std::string_view::npos) return false;
  const auto is_plain = [](const std::string& word) {
    return is_decimal_comma(word) || is_number(word, false);
  };
  return std::ranges::all_of(words, is_plain);
}

}  // namespace

std::string_view row_text(std::string_view line, char separator) {
  if (separator != '\t') return trimmed(line);
  const auto is_around = [](char c) { return c == ' ' || c == '\r'; };
  while (!line.empty() && is_around(line.front())) line.remove_prefix(1);
  while (!line.empty() && is_around(line.back())) line.remove_suffix(1);
  return line;
}

std::string_view without_quotes(std::string_view cell) {
  cell = trimmed(cell);
  const bool quoted =
      cell.size() > 1 && cell.front() == cell.back() && (cell.front() == '"' || cell.front() == '\'');
  return quoted ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

std::optional<std::string_view> comment_of(std::string_view line) {
  line = trimmed(line);
  for (const std::string_view mark : {"//", "#", "%"})
    if (line.starts_with(mark))
      return trimmed(line.substr(std::min(line.find_first_not_of("/#%"), line.size())));
  return std::nullopt;
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  for_each_cell(line, separator,
                [&](std::size_t, std::string_view cell) { cells.emplace_back(without_quotes(cell)); });
  return cells;
}

std::vector<std::string> names_of(std::string_view line, char separator) {
  if (separator != ' ') return cells_of(line, separator);
  std::vector<std::string> names;
  bool is_open = false;
  for_each_cell(line, ' ', [&](std::size_t, std::string_view cell) {
    const bool begins =
        !names.empty() && std::string_view("([{<").find(cell.front()) != std::string_view::npos;
    if (begins || is_open)
      names.back() += " " + std::string(cell);
    else
      names.emplace_back(without_quotes(cell));
    const std::size_t bracket = cell.find_last_of("([{<)]}>");
    if (bracket != std::string_view::npos)
      is_open = std::string_view("([{<").find(cell[bracket]) != std::string_view::npos;
  });
  return names;
}

std::optional<double> cell_value(std::string_view cell, bool has_decimal_commas) {
  cell = without_quotes(cell);
  const ParsedNumber number = number_in(cell, has_decimal_commas);
  if (number.outcome == ParsedNumber::Outcome::number) return number.value;
  if (is_missing(cell)) return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

bool is_number(std::string_view cell, bool has_decimal_commas) {
  return number_in(without_quotes(cell), has_decimal_commas).outcome != ParsedNumber::Outcome::not_a_number;
}

std::optional<std::int64_t> whole_number(std::string_view cell) { return exact_number<std::int64_t>(cell); }

RowForm form_of(std::string_view row) {
  row = trimmed(row);
  const bool has_comma = row.find(',') != std::string_view::npos;
  for (const char separator : {';', '\t'}) {
    const std::vector<std::string> cells = cells_of(row, separator);
    const auto ends_in_comma = [](const std::string& cell) { return cell.ends_with(','); };
    if (cells.size() < (has_comma ? 3U : 2U) || std::ranges::any_of(cells, ends_in_comma)) continue;
    if (separator == '\t' && row.find(' ') != std::string_view::npos) continue;
    return {separator, std::ranges::any_of(cells, is_decimal_comma)};
  }
  if (!has_comma) return {};
  return has_decimals_between_blanks(row) ? RowForm{' ', true} : RowForm{',', false};
}

bool is_row(std::string_view line) {
  const RowForm form = form_of(line);
  const std::vector<std::string> cells = cells_of(line, form.separator);
  std::size_t numbers = 0;
  std::size_t others = 0;
  for (const std::string& cell : cells)
    if (is_number(cell, form.has_decimal_commas))
      ++numbers;
    else if (!is_missing(cell))
      ++others;
  return numbers >= 3 || (numbers > 0 && others == 0);
}

}  // namespace landfall
