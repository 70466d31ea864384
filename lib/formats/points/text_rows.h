// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/points/cloud_bytes.h"
#include "formats/points/cloud_reader.h"
#include "formats/points/text_cells.h"

namespace landfall {

/// Text whose rows begin at an offset, and the number of points that a header declares.
struct TextRows {
  std::uint64_t begin = 0;
  std::size_t first_line = 1;  ///< number of the line there, for messages
  std::optional<std::int64_t> count{};
  bool may_continue = false;  ///< other elements may follow the declared points
  RowForm form{};
  std::size_t column_count = 0;
};

/// Reads rows of text as points. Blocks of whole lines are divided into pieces, which are parsed on all
/// threads.
class TextReader final : public CloudReader {
 public:
  /// Throws FormatError for a declared count of 0.
  TextReader(std::unique_ptr<CloudBytes> file, const TextRows& rows, CloudInfo info);

  bool next(CloudBatch& batch) override;
  void rewind() override;
  [[nodiscard]] double progress() const override {
    return static_cast<double>(at_) / static_cast<double>(file_->size());
  }
  /// The offset and the number of the line behind the rows that next() has read.
  [[nodiscard]] std::uint64_t position() const { return at_; }
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  struct Piece;

  [[nodiscard]] std::int64_t time_base_of(std::string_view text) const;
  [[nodiscard]] std::optional<double> value_of(std::string_view cell, std::size_t field) const;
  [[nodiscard]] bool is_done() const;
  void read_block(CloudBatch& batch);
  [[nodiscard]] std::string_view declared_part(std::string_view text) const;
  [[nodiscard]] std::vector<Piece> divided(std::string_view text) const;
  void parse(Piece& piece) const;
  [[nodiscard]] std::string parse_line(std::string_view line, CloudBatch& rows) const;
  [[nodiscard]] std::string refusal(std::string_view cell, std::size_t field) const;
  void append(const Piece& piece, CloudBatch& batch);

  std::unique_ptr<CloudBytes> file_;
  TextRows rows_;
  char line_end_ = '\n';
  std::vector<std::pair<std::size_t, std::size_t>> wanted_;  ///< column of the file and field, ascending
  std::vector<std::byte> block_;
  std::uint64_t at_ = 0;
  std::size_t line_ = 1;
  std::int64_t point_ = 0;
};

}  // namespace landfall
