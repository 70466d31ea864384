// SPDX-License-Identifier: GPL-3.0-or-later
// Text with a header, in a comment or not, or without one.
#include <algorithm>
#include <utility>

#include "base/text/characters.h"
#include "base/text/foreign_content.h"
#include "base/text/shown_text.h"
#include "base/units/spelled_unit.h"
#include "formats/points/cloud_formats.h"
#include "formats/points/text_head.h"
#include "formats/points/text_rows.h"

namespace landfall {
namespace {

/// The columns of the .xyz files of HELIOS++.
const std::vector<std::string>& helios_columns() {
  static const std::vector<std::string> kNames = {"x",
                                                  "y",
                                                  "z",
                                                  "intensity",
                                                  "echo_width",
                                                  "return_number",
                                                  "number_of_returns",
                                                  "fullwave_index",
                                                  "hit_object",
                                                  "class",
                                                  "t"};
  return kNames;
}

/// 11 numbers: numbers of the return, of the returns, of the pulse, of the object and the class are whole.
bool is_helios(const std::vector<std::string>& cells) {
  if (cells.size() != helios_columns().size()) return false;
  for (std::size_t i = 5; i < 10; ++i)
    if (!whole_number(cells[i])) return false;
  return *whole_number(cells[5]) >= 0 && *whole_number(cells[5]) <= *whole_number(cells[6]);
}

/// The rows at the beginning of a file, from which its columns are identified.
struct SampleRows {
  RowForm form;
  std::vector<std::vector<std::string>> cells;  ///< of each row
  std::size_t first_line = 0;                   ///< the number of that of the first row
  std::size_t column_count = 0;                 ///< of the first row
  bool ends_in_separator = false;               ///< the first row, whose last cell may be empty
  /// The first cell of a column that is text, neither a number nor missing.
  [[nodiscard]] std::optional<std::string> text_in(std::size_t column) const {
    for (const auto& row : cells)
      if (column < row.size() && !cell_value(row[column], form.has_decimal_commas)) return row[column];
    return std::nullopt;
  }
};

SampleRows sample_rows(const TextHead& head, std::size_t first) {
  SampleRows sample;
  if (first >= head.lines.size()) return sample;
  sample.form = form_of(head.lines[first].text);
  for (std::size_t i = first; i < head.lines.size(); ++i) {
    sample.cells.push_back(cells_of(head.lines[i].text, sample.form.separator));
    const RowForm form = form_of(head.lines[i].text);
    if (form.separator == sample.form.separator) sample.form.has_decimal_commas |= form.has_decimal_commas;
  }
  sample.first_line = head.lines[first].number;
  sample.column_count = sample.cells.front().size();
  const char separator = sample.form.separator;
  sample.ends_in_separator =
      separator != ' ' && row_text(head.lines[first].text, separator).ends_with(separator);
  const bool is_short = std::ranges::any_of(
      sample.cells, [&](const auto& row) { return row.size() == sample.column_count + 1; });
  if (sample.ends_in_separator && is_short) ++sample.column_count;
  return sample;
}

/// The names in a header for rows of `count` cells, divided as the rows are or as the header itself says.
std::vector<std::string> header_names(std::string_view header, const SampleRows& sample) {
  std::vector<std::string> names = names_of(header, sample.form.separator);
  const char own = form_of(header).separator;
  for (const char separator : {own, ' '})
    if (names.size() != sample.column_count)
      if (std::vector<std::string> others = names_of(header, separator); others.size() > names.size())
        names = std::move(others);
  return names;
}

/// True for increasing whole numbers, or text: the numbers or names of rows.
bool holds_row_names(const SampleRows& sample) {
  std::optional<std::int64_t> last;
  for (const auto& row : sample.cells) {
    const auto number = whole_number(row.front());
    if (!number) return !is_number(row.front(), sample.form.has_decimal_commas);
    if (last && *number <= *last) return false;
    last = number;
  }
  return sample.cells.size() > 1;
}

/// R and pandas write the numbers of rows without a name.
void name_first_column(const CloudBytes& file, std::vector<std::string>& names, SampleRows& sample) {
  if (sample.ends_in_separator && names.size() == sample.column_count + 1) ++sample.column_count;
  const std::size_t count = sample.column_count;
  if (count == 0 || names.size() == count) return;
  if (names.size() + 1 != count || !holds_row_names(sample))
    file.fail("line " + std::to_string(sample.first_line) + ": has " + std::to_string(count) +
              " cells, but the header has " + std::to_string(names.size()) + " names");
  names.insert(names.begin(), "");
}

/// Leaves out the columns of text that no point needs.
void leave_text_out(const std::vector<std::string>& names, const SampleRows& sample,
                    const ColumnChoice& choice, CloudTable& table) {
  for (std::size_t f = static_cast<std::size_t>(CloudField::z) + 1; f < kCloudFieldCount; ++f) {
    if (!table.columns[f] || is_chosen(choice, static_cast<CloudField>(f))) continue;
    const std::size_t column = *table.columns[f];
    const auto text = sample.text_in(column);
    if (!text) continue;
    table.notes.push_back("its column " + shown_word(names[column]) +
                          " is left out: it holds text, such as '" + shown_word(*text) + "'");
    table.columns[f].reset();
    table.units[f] = {};
  }
}

/// A comment with as many names as there are columns is a header.
std::optional<std::vector<std::string>> commented_names(const TextHead& head, const SampleRows& sample,
                                                        const ColumnChoice& choice) {
  std::optional<std::vector<std::string>> found;
  for (auto comment = head.comments.rbegin(); comment != head.comments.rend(); ++comment) {
    std::vector<std::string> names = header_names(*comment, sample);
    if (names.size() != sample.column_count) continue;
    if (names_a_cloud(names, choice)) return names;
    if (!found && names_a_field(names)) found = std::move(names);
  }
  return found;
}

std::string list_of(const CloudColumns& columns) {
  return std::to_string(*columns[0] + 1) + ", " + std::to_string(*columns[1] + 1) + ", " +
         std::to_string(*columns[2] + 1);
}

CloudInfo with_header(const CloudBytes& file, std::vector<std::string> names, SampleRows& sample,
                      const ColumnChoice& choice) {
  name_first_column(file, names, sample);
  CloudTable table = cloud_columns(names, choice, file.name());
  if (names.front().empty() && sample.column_count > 0)
    table.notes.emplace_back("its first column has no name: it is left out, as the numbers of rows");
  leave_text_out(names, sample, choice, table);
  return info_of("text with a header", std::move(table));
}

CloudInfo without_header(const CloudBytes& file, const TextHead& head, SampleRows& sample,
                         const ColumnChoice& choice) {
  if (auto names = commented_names(head, sample, choice))
    return with_header(file, std::move(*names), sample, choice);
  if (is_helios(sample.cells.front()))
    return info_of("HELIOS++ xyz", cloud_columns(helios_columns(), choice, file.name()));
  std::vector<bool> is_number(sample.column_count, true);
  for (std::size_t i = 0; i < sample.cells.front().size(); ++i)
    is_number[i] = cell_value(sample.cells.front()[i], sample.form.has_decimal_commas).has_value();
  CloudTable table = numbered_columns(is_number, choice, file.name());
  if (choice.size() < 3)
    table.notes.emplace_back("has no header: its columns " + list_of(table.columns) +
                             " are taken as x, y, z" +
                             std::string(is_number.size() > 3 ? ", the others are ignored" : ""));
  return info_of("text without a header", std::move(table));
}

/// A comment such as "units: mm" is no header, so that nothing follows it.
void note_unit_in_comments(const TextHead& head, CloudInfo& info) {
  if (info.units[0].kind != ColumnUnit::Kind::unstated) return;
  for (const std::string_view comment : head.comments) {
    const std::vector<std::string> words = cells_of(comment, ' ');
    const auto is_unit = [](const std::string& word) { return lower_case(word).starts_with("unit"); };
    const auto unit = std::ranges::find_if(words, is_unit);
    const bool has_length = std::any_of(unit, words.end(), [](const std::string& word) {
      const double metres = spelled_unit(word).metres;
      return metres > 0 && metres != 1;
    });
    if (has_length)
      info.notes.push_back("its comment '" + shown_word(comment) +
                           "' is ignored: units are read from the names of columns, such as x [mm]");
  }
}

/// .pts begins with the number of its points.
std::optional<std::int64_t> count_of_pts(const TextHead& head) {
  if (head.lines.size() < 2) return std::nullopt;
  const auto count = whole_number(trimmed(head.lines[0].text));
  return count && *count >= 0 ? count : std::nullopt;
}

}  // namespace

std::unique_ptr<CloudReader> open_text_cloud(std::unique_ptr<CloudBytes> file, const ColumnChoice& choice) {
  std::vector<std::byte> bytes = beginning_of_text(*file);
  const std::string_view text = text_of(bytes);
  if (const std::string foreign = foreign_content(text); !foreign.empty()) file->fail(foreign);
  if (text.find('\0') != std::string_view::npos)
    file->fail("is not a point cloud in a format that is read: LAS, PLY, PCD, PTX, QFIT, CSV or XYZ");
  const std::size_t mark = text.size() - without_byte_order_mark(text).size();
  std::fill_n(bytes.begin(), mark, std::byte{' '});  // offsets stay those of the file
  const bool is_all = bytes.size() == file->size();
  const TextHead head = text_head(text, is_all);
  if (!is_all && head.lines.size() < 2)
    file->fail("has no row of points in its first " + std::to_string(bytes.size() >> 20U) +
               " MiB: shorten its comments or its header");
  if (head.lines.empty()) file->fail("has no points");
  TextRows rows;
  rows.count = count_of_pts(head);
  std::size_t first = rows.count ? 1 : 0;
  const bool has_header = !is_row(head.lines[first].text);
  SampleRows sample = sample_rows(head, has_header ? first + 1 : first);
  CloudInfo info = has_header
                       ? with_header(*file, header_names(head.lines[first].text, sample), sample, choice)
                       : without_header(*file, head, sample, choice);
  note_unit_in_comments(head, info);
  if (has_header) ++first;
  const bool has_rows = first < head.lines.size();
  rows.begin = std::max(has_rows ? head.lines[first].at : head.end, mark);
  rows.first_line = has_rows ? head.lines[first].number : 1;
  rows.form = sample.form;
  rows.column_count = sample.column_count;
  if (sample.form.has_decimal_commas) info.notes.emplace_back("its commas are taken as those of decimals");
  return std::make_unique<TextReader>(std::move(file), rows, std::move(info));
}

}  // namespace landfall
