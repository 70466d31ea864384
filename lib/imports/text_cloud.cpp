// SPDX-License-Identifier: GPL-3.0-or-later
// Points as lines of text. Blocks of whole lines are divided into pieces, which are parsed on all threads.
#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

#include "base/foreign_content.h"
#include "base/parallel.h"
#include "base/parsed_number.h"
#include "base/shown_text.h"
#include "imports/cloud_formats.h"

namespace landfall {
namespace {

constexpr std::size_t kBlock = 1U << 23U;
constexpr std::size_t kPiece = 1U << 18U;
constexpr std::size_t kHead = 1U << 18U;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view without_quotes(std::string_view cell) {
  cell = trimmed(cell);
  const bool quoted =
      cell.size() > 1 && cell.front() == cell.back() && (cell.front() == '"' || cell.front() == '\'');
  return quoted ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

/// The text of a comment without the characters that begin it; nothing for another line.
std::optional<std::string_view> comment_of(std::string_view line) {
  line = trimmed(line);
  for (const std::string_view mark : {"//", "#", "%"})
    if (line.starts_with(mark))
      return trimmed(line.substr(std::min(line.find_first_not_of("/#%"), line.size())));
  return std::nullopt;
}

/// Calls use(number of the cell, cell) for each cell of a line; returns their number. Blanks divide where the
/// separator is one; an empty last cell does not count.
template <class Use>
std::size_t for_each_cell(std::string_view line, char separator, const Use& use) {
  std::size_t count = 0;
  line = trimmed(line);
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

char separator_of(std::string_view line) {
  char best = ' ';
  std::ptrdiff_t most = 0;
  for (const char candidate : {';', '\t', ','})
    if (const auto count = std::ranges::count(line, candidate); count > most) {
      best = candidate;
      most = count;
    }
  return best == '\t' && trimmed(line).find(' ') != std::string_view::npos ? ' ' : best;
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  for_each_cell(line, separator,
                [&](std::size_t, std::string_view cell) { cells.emplace_back(without_quotes(cell)); });
  return cells;
}

bool is_number(std::string_view cell) {
  return parsed_number(cell).outcome != ParsedNumber::Outcome::not_a_number;
}

std::optional<std::int64_t> whole_number(std::string_view cell) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

/// The rows of a piece of text, or the first line that is none.
struct Piece {
  std::string_view text;
  CloudBatch rows;
  std::size_t lines = 0;
  std::string error;
};

class TextReader final : public CloudReader {
 public:
  TextReader(std::unique_ptr<CloudBytes> file, const TextRows& rows, CloudInfo info)
      : file_(std::move(file)), rows_(rows) {
    info_ = std::move(info);
    info_.point_count = rows.count;
    for (std::size_t f = 0; f < kCloudFieldCount; ++f)
      if (info_.columns[f]) wanted_.emplace_back(*info_.columns[f], f);
    std::ranges::sort(wanted_);
    if (rows.count && *rows.count == 0) file_->fail("has no points");
    const std::vector<std::byte> head = file_->up_to(rows.begin, kHead);
    const std::string_view text = as_text(head);
    if (text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos)
      line_end_ = '\r';
    if (info_.has(CloudField::t)) info_.time_base = time_base_of(text);
    TextReader::rewind();
  }

  bool next(CloudBatch& batch) override {
    for (auto& column : batch.columns) column.clear();
    while (batch.size() == 0 && at_ < file_->size() && !is_done()) read_block(batch);
    point_ += static_cast<std::int64_t>(batch.size());
    if (batch.size() > 0) return true;
    if (rows_.count && point_ < *rows_.count)
      file_->fail("declares " + std::to_string(*rows_.count) + " points, but has " + std::to_string(point_) +
                  ": it is truncated");
    return false;
  }

  void rewind() override {
    at_ = rows_.begin;
    line_ = rows_.first_line;
    point_ = 0;
  }

  [[nodiscard]] double progress() const override {
    return static_cast<double>(at_) / static_cast<double>(file_->size());
  }

 private:
  static std::string_view as_text(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// The first time if it is an integer that a double cannot hold; else 0.
  [[nodiscard]] std::int64_t time_base_of(std::string_view text) const {
    std::int64_t base = 0;
    while (!text.empty()) {
      const std::size_t end = std::min(text.find(line_end_), text.size());
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (trimmed(line).empty() || comment_of(line)) continue;
      for_each_cell(line, rows_.separator, [&](std::size_t c, std::string_view cell) {
        if (c == *info_.columns[static_cast<std::size_t>(CloudField::t)])
          base = time_base(whole_number(without_quotes(cell)).value_or(0));
      });
      break;
    }
    return base;
  }

  /// Declared points have been read, and what follows is not theirs.
  [[nodiscard]] bool is_done() const { return rows_.may_continue && rows_.count && point_ >= *rows_.count; }

  void read_block(CloudBatch& batch) {
    block_ = file_->up_to(at_, kBlock);
    std::string_view text = as_text(block_);
    if (at_ + text.size() < file_->size()) {
      const std::size_t last = text.rfind(line_end_);
      if (last == std::string_view::npos)
        file_->fail("line " + std::to_string(line_) + " has more than 8 MiB");
      text = text.substr(0, last + 1);
    }
    if (rows_.may_continue) text = declared_part(text);
    if (text.find('\0') != std::string_view::npos)
      file_->fail("is binary behind line " + std::to_string(line_) + ", not text");
    std::vector<Piece> pieces = divided(text);
    parallel_for(pieces.size(), 1, [&](std::size_t i, std::size_t) { parse(pieces[i]); });
    for (const Piece& piece : pieces) append(piece, batch);
    at_ += text.size();
    if (rows_.count && point_ + static_cast<std::int64_t>(batch.size()) > *rows_.count)
      file_->fail("declares " + std::to_string(*rows_.count) + " points, but has more");
  }

  /// The lines up to the last declared point.
  [[nodiscard]] std::string_view declared_part(std::string_view text) const {
    std::int64_t left = *rows_.count - point_;
    std::size_t end = 0;
    while (left > 0 && end < text.size()) {
      const std::size_t next = std::min(text.find(line_end_, end), text.size() - 1) + 1;
      if (!trimmed(text.substr(end, next - end - (text[next - 1] == line_end_ ? 1 : 0))).empty()) --left;
      end = next;
    }
    return text.substr(0, end);
  }

  [[nodiscard]] std::vector<Piece> divided(std::string_view text) const {
    std::vector<Piece> pieces;
    while (!text.empty()) {
      std::size_t end = text.size();
      if (end > kPiece) end = std::min(text.find(line_end_, kPiece), text.size() - 1) + 1;
      pieces.push_back({text.substr(0, end), {}, 0, {}});
      text.remove_prefix(end);
    }
    return pieces;
  }

  void parse(Piece& piece) const {
    std::string_view text = piece.text;
    while (!text.empty() && piece.error.empty()) {
      const std::size_t end = std::min(text.find(line_end_), text.size());
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (!trimmed(line).empty() && !comment_of(line)) piece.error = parse_line(line, piece.rows);
      if (piece.error.empty()) ++piece.lines;
    }
  }

  /// Appends a row; returns what is wrong with the line.
  std::string parse_line(std::string_view line, CloudBatch& rows) const {
    std::string error;
    auto wanted = wanted_.begin();
    const std::size_t count = for_each_cell(line, rows_.separator, [&](std::size_t c, std::string_view cell) {
      for (; wanted != wanted_.end() && wanted->first == c; ++wanted)
        if (!take(cell, wanted->second, rows) && error.empty())
          error = "'" + shown_word(cell) + "' is not a number" +
                  (cell.find(',') != std::string_view::npos ? " (decimal commas are not read)" : "");
    });
    if (!error.empty() || count == rows_.column_count) return error;
    return "has " + std::to_string(count) + " cells, not " + std::to_string(rows_.column_count);
  }

  /// Empty cells are NaN.
  bool take(std::string_view cell, std::size_t field, CloudBatch& rows) const {
    std::vector<double>& column = rows.columns[field];
    cell = without_quotes(cell);
    const bool is_from_base = info_.time_base != 0 && field == static_cast<std::size_t>(CloudField::t);
    if (is_from_base) {
      if (const auto time = whole_number(cell)) {
        column.push_back(time_from(info_.time_base, *time));
        return true;
      }
    }
    const ParsedNumber number =
        cell.empty() ? ParsedNumber{ParsedNumber::Outcome::number, std::numeric_limits<double>::quiet_NaN()}
                     : parsed_number(cell);
    column.push_back(is_from_base ? number.value - static_cast<double>(info_.time_base) : number.value);
    return number.outcome == ParsedNumber::Outcome::number;
  }

  void append(const Piece& piece, CloudBatch& batch) {
    line_ += piece.lines;
    if (!piece.error.empty()) file_->fail("line " + std::to_string(line_) + ": " + piece.error);
    for (std::size_t f = 0; f < kCloudFieldCount; ++f)
      batch.columns[f].insert(batch.columns[f].end(), piece.rows.columns[f].begin(),
                              piece.rows.columns[f].end());
  }

  std::unique_ptr<CloudBytes> file_;
  TextRows rows_;
  char line_end_ = '\n';
  std::vector<std::pair<std::size_t, std::size_t>> wanted_;  ///< column of the file and field, ascending
  std::vector<std::byte> block_;
  std::uint64_t at_ = 0;
  std::size_t line_ = 1;
  std::int64_t point_ = 0;
};

/// The lines at the beginning of a file, up to the first row.
struct TextHead {
  std::vector<std::string_view> comments;
  std::string_view first;   ///< the first line that is no comment
  std::string_view second;  ///< the line after it
  TextRows at_first{}, at_second{};
};

TextHead read_head(const CloudBytes& file, std::string_view text) {
  TextHead head;
  const char end_of_line = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  TextRows here;
  while (here.begin < text.size()) {
    const std::size_t end = std::min(text.find(end_of_line, here.begin), text.size());
    const std::string_view line = trimmed(text.substr(here.begin, end - here.begin));
    const TextRows after{.begin = std::min(end + 1, text.size()), .first_line = here.first_line + 1};
    if (const auto comment = comment_of(line)) {
      head.comments.push_back(*comment);
    } else if (!line.empty() && head.first.empty()) {
      head.first = line;
      head.at_first = here;
      head.at_second = after;
    } else if (!line.empty()) {
      head.second = line;
      break;
    }
    here = after;
  }
  if (head.first.empty()) file.fail("has no points");
  return head;
}

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

/// Names among the comments, for as many columns.
std::optional<std::vector<std::string>> commented_names(const TextHead& head, std::size_t count,
                                                        const ColumnChoice& choice) {
  for (auto comment = head.comments.rbegin(); comment != head.comments.rend(); ++comment) {
    std::vector<std::string> names = cells_of(*comment, separator_of(*comment));
    if (names.size() == count && names_a_cloud(names, choice)) return names;
  }
  return std::nullopt;
}

CloudInfo without_header(const CloudBytes& file, const TextHead& head, const std::vector<std::string>& cells,
                         const ColumnChoice& choice) {
  if (const auto names = commented_names(head, cells.size(), choice))
    return {.format = "text with a header", .columns = cloud_columns(*names, choice, file.name())};
  if (is_helios(cells))
    return {.format = "HELIOS++ xyz", .columns = cloud_columns(helios_columns(), choice, file.name())};
  CloudInfo info{.format = "text without a header",
                 .columns = numbered_columns(cells.size(), choice, file.name())};
  if (choice.size() < 3)
    info.notes.emplace_back("has no header: its columns 1, 2, 3 are taken as x, y, z" +
                            std::string(cells.size() > 3 ? ", the others are ignored" : ""));
  return info;
}

}  // namespace

std::unique_ptr<CloudReader> read_text_rows(std::unique_ptr<CloudBytes> file, const TextRows& rows,
                                            CloudInfo info) {
  return std::make_unique<TextReader>(std::move(file), rows, std::move(info));
}

std::unique_ptr<CloudReader> open_text_cloud(std::unique_ptr<CloudBytes> file, const ColumnChoice& choice) {
  std::vector<std::byte> bytes = file->up_to(0, kHead);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (const std::string foreign = foreign_content(text); !foreign.empty()) file->fail(foreign);
  if (text.find('\0') != std::string_view::npos)
    file->fail("is not a point cloud in a format that is read: LAS, PLY, PCD, CSV or XYZ");
  const std::size_t mark = text.size() - without_byte_order_mark(text).size();
  std::fill_n(bytes.begin(), mark, std::byte{' '});  // offsets stay those of the file
  TextHead head = read_head(*file, text);
  std::vector<std::string> cells = cells_of(head.first, separator_of(head.first));
  TextRows rows = head.at_first;
  CloudInfo info;
  if (cells.size() == 1 && whole_number(cells[0]) && *whole_number(cells[0]) >= 0 && !head.second.empty()) {
    rows = head.at_second;  // .pts: the number of points, then x y z and others
    rows.count = whole_number(cells[0]);
    head.first = head.second;
    cells = cells_of(head.first, separator_of(head.first));
    info = without_header(*file, head, cells, choice);
  } else if (is_number(cells.front())) {
    info = without_header(*file, head, cells, choice);
  } else {
    rows = head.at_second;
    info = {.format = "text with a header", .columns = cloud_columns(cells, choice, file->name())};
  }
  if (rows.begin == 0) rows.begin = mark;
  rows.separator = separator_of(head.first);
  rows.column_count = cells.size();
  return read_text_rows(std::move(file), rows, std::move(info));
}

}  // namespace landfall
