// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "base/text/characters.h"
#include "formats/points/cloud_fields.h"
#include "formats/points/text_head.h"

namespace landfall {
namespace {

/// The number of lines that decide the kind of a text.
constexpr std::size_t kProbed = 20;
constexpr std::size_t kMaxComments = 1U << 16U;

std::size_t cell_count(std::string_view line) { return cells_of(line, form_of(line).separator).size(); }

/// True for a line that holds nothing but numbers and missing values.
bool holds_numbers_only(std::string_view line) {
  const RowForm form = form_of(line);
  return std::ranges::all_of(cells_of(line, form.separator), [&](const std::string& cell) {
    return cell_value(cell, form.has_decimal_commas).has_value();
  });
}

}  // namespace

std::vector<std::byte> beginning_of_text(const CloudBytes& file) {
  constexpr std::size_t kLines = 3;  // the number of the points of a .pts, a header and a row
  return beginning_of(file, [](std::string_view text) {
    return text.find('\0') != std::string_view::npos || text_head(text, false).lines.size() >= kLines;
  });
}

TextHead text_head(std::string_view text, bool is_all) {
  TextHead head;
  const char end_of_line = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  for (std::size_t number = 1; head.end < text.size(); ++number) {
    const std::size_t end = text.find(end_of_line, head.end);
    if (end == std::string_view::npos && !is_all && !head.lines.empty()) break;
    const std::size_t length = std::min(end, text.size()) - head.end;
    const std::string_view line = text.substr(head.end, length);
    const auto comment = comment_of(line);
    if (comment && head.lines.empty() && head.comments.size() < kMaxComments)
      head.comments.push_back(*comment);
    else if (!comment && !trimmed(line).empty())
      head.lines.push_back({line, head.end, number});
    head.end = std::min(head.end + length + 1, text.size());
  }
  return head;
}

bool holds_rows_of_points(const TextHead& head) {
  if (is_ptx(head)) return true;
  if (head.lines.empty()) return false;
  const std::size_t first = holds_numbers_only(head.lines[0].text) ? 0 : 1;
  if (first == 1) {
    const std::string_view header = head.lines[0].text;
    const std::vector<std::string> names = names_of(header, form_of(header).separator);
    if (!names_a_cloud(names, {}) && !names_a_field(names)) return false;
  }
  if (first >= head.lines.size()) return false;
  const std::size_t count = cell_count(head.lines[first].text);
  for (std::size_t i = first; i < std::min(head.lines.size(), kProbed); ++i)
    if (const std::string_view line = head.lines[i].text; !is_row(line) || cell_count(line) != count)
      return false;
  return count >= 3;
}

bool is_ptx(const TextHead& head) {
  constexpr std::array<std::size_t, 10> kCells = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
  if (head.lines.size() < 3) return false;
  for (std::size_t i = 0; i < std::min(head.lines.size(), kCells.size()); ++i) {
    const std::string_view line = head.lines[i].text;
    if (!is_row(line) || cell_count(line) != kCells[i]) return false;
    if (i < 2 && !whole_number(trimmed(line))) return false;
  }
  return true;
}

bool is_grid_text(std::string_view text) {
  constexpr std::array<std::string_view, 13> kFirst = {
      "ncols", "nrows", "xllcorner",    "yllcorner", "xllcenter", "yllcenter", "cellsize",
      "dx",    "dy",    "nodata_value", "dsaa",      "north:",    "south:"};
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  const std::string first = lower_case(std::string(text.substr(0, text.find_first_of(" \t\r\n"))));
  return std::ranges::find(kFirst, first) != kFirst.end();
}

}  // namespace landfall
