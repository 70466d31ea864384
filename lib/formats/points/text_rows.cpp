// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/text_rows.h"

#include "base/core/parallel.h"
#include "base/text/shown_text.h"
#include "formats/points/cloud_formats.h"

namespace landfall {
namespace {

constexpr std::size_t kBlock = 1U << 23U;
constexpr std::size_t kPiece = 1U << 18U;
constexpr std::size_t kHead = 1U << 18U;

}  // namespace

/// The rows of a piece of text, or the first line that is none.
struct TextReader::Piece {
  std::string_view text;
  CloudBatch rows;
  std::size_t lines = 0;
  std::string error;
};

TextReader::TextReader(std::unique_ptr<CloudBytes> file, const TextRows& rows, CloudInfo info)
    : file_(std::move(file)), rows_(rows) {
  info_ = std::move(info);
  info_.point_count = rows.count;
  for (std::size_t f = 0; f < kCloudFieldCount; ++f)
    if (info_.columns[f]) wanted_.emplace_back(*info_.columns[f], f);
  std::ranges::sort(wanted_);
  if (rows.count && *rows.count == 0) file_->fail("has no points");
  const std::vector<std::byte> head = file_->up_to(rows.begin, kHead);
  const std::string_view text = text_of(head);
  if (text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos)
    line_end_ = '\r';
  if (info_.has(CloudField::t)) info_.time_base = time_base_of(text);
  TextReader::rewind();
}

/// The first time if it is an integer that a double cannot hold; else 0.
std::int64_t TextReader::time_base_of(std::string_view text) const {
  std::int64_t base = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(line_end_), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (trimmed(line).empty() || comment_of(line)) continue;
    for_each_cell(line, rows_.form.separator, [&](std::size_t c, std::string_view cell) {
      if (c == *info_.columns[kTimeField]) base = time_base(whole_number(without_quotes(cell)).value_or(0));
    });
    break;
  }
  return base;
}

/// The number of a cell; a time is counted from the base.
std::optional<double> TextReader::value_of(std::string_view cell, std::size_t field) const {
  const std::int64_t base = field == kTimeField ? info_.time_base : 0;
  if (base != 0)
    if (const auto time = whole_number(without_quotes(cell))) return time_from(base, *time);
  std::optional<double> value = cell_value(cell, rows_.form.has_decimal_commas);
  if (value && base != 0) *value -= static_cast<double>(base);
  return value;
}

bool TextReader::next(CloudBatch& batch) {
  for (auto& column : batch.columns) column.clear();
  while (batch.size() == 0 && at_ < file_->size() && !is_done()) read_block(batch);
  point_ += static_cast<std::int64_t>(batch.size());
  if (batch.size() > 0) return true;
  if (rows_.count && point_ < *rows_.count)
    file_->fail("declares " + std::to_string(*rows_.count) + " points, but has " + std::to_string(point_) +
                ": it is truncated");
  return false;
}

void TextReader::rewind() {
  at_ = rows_.begin;
  line_ = rows_.first_line;
  point_ = 0;
}

/// All declared points have been read; the remaining text does not belong to them.
bool TextReader::is_done() const { return rows_.may_continue && rows_.count && point_ >= *rows_.count; }

void TextReader::read_block(CloudBatch& batch) {
  block_ = file_->up_to(at_, kBlock);
  std::string_view text = text_of(block_);
  if (at_ + text.size() < file_->size()) {
    const std::size_t last = text.rfind(line_end_);
    if (last == std::string_view::npos) file_->fail("line " + std::to_string(line_) + " has more than 8 MiB");
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
std::string_view TextReader::declared_part(std::string_view text) const {
  std::int64_t left = *rows_.count - point_;
  std::size_t end = 0;
  while (left > 0 && end < text.size()) {
    const std::size_t next = std::min(text.find(line_end_, end), text.size() - 1) + 1;
    if (!trimmed(text.substr(end, next - end - (text[next - 1] == line_end_ ? 1 : 0))).empty()) --left;
    end = next;
  }
  return text.substr(0, end);
}

std::vector<TextReader::Piece> TextReader::divided(std::string_view text) const {
  std::vector<Piece> pieces;
  while (!text.empty()) {
    std::size_t end = text.size();
    if (end > kPiece) end = std::min(text.find(line_end_, kPiece), text.size() - 1) + 1;
    pieces.push_back({text.substr(0, end), {}, 0, {}});
    text.remove_prefix(end);
  }
  return pieces;
}

void TextReader::parse(Piece& piece) const {
  std::string_view text = piece.text;
  while (!text.empty() && piece.error.empty()) {
    const std::size_t end = std::min(text.find(line_end_), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!trimmed(line).empty() && !comment_of(line)) piece.error = parse_line(line, piece.rows);
    if (piece.error.empty()) ++piece.lines;
  }
}

/// Appends a row; returns what is wrong with the line. The last cell may be empty, behind the last separator.
std::string TextReader::parse_line(std::string_view line, CloudBatch& rows) const {
  std::string error;
  auto wanted = wanted_.begin();
  const auto take = [&](std::size_t c, std::string_view cell) {
    for (; wanted != wanted_.end() && wanted->first == c; ++wanted) {
      const std::optional<double> value = value_of(cell, wanted->second);
      if (!value && error.empty()) error = refusal(cell, wanted->second);
      rows.columns[wanted->second].push_back(value.value_or(0));
    }
  };
  std::size_t count = for_each_cell(line, rows_.form.separator, take);
  const char separator = rows_.form.separator;
  if (count + 1 == rows_.column_count && separator != ' ' && row_text(line, separator).ends_with(separator))
    take(count++, "");
  if (!error.empty() || count == rows_.column_count) return error;
  return "has " + std::to_string(count) + " cells, not " + std::to_string(rows_.column_count);
}

std::string TextReader::refusal(std::string_view cell, std::size_t field) const {
  const std::string what = "'" + shown_word(cell) + "' is not a number";
  if (rows_.form.has_decimal_commas && cell.find('.') != std::string_view::npos)
    return what + ": elsewhere the file has decimal commas, not points";
  if (rows_.form.separator != ',' && cell.find(',') != std::string_view::npos)
    return what + (rows_.form.separator == ' ' ? ": blanks must divide the values, and points their decimals"
                                               : ": elsewhere the file has decimal points, not commas");
  if (field <= static_cast<std::size_t>(CloudField::z)) return what;
  return what + ": --columns " + name_of(static_cast<CloudField>(field)) + "=- leaves its column out";
}

void TextReader::append(const Piece& piece, CloudBatch& batch) {
  line_ += piece.lines;
  if (!piece.error.empty()) file_->fail("line " + std::to_string(line_) + ": " + piece.error);
  for (std::size_t f = 0; f < kCloudFieldCount; ++f)
    batch.columns[f].insert(batch.columns[f].end(), piece.rows.columns[f].begin(),
                            piece.rows.columns[f].end());
}

}  // namespace landfall
