// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "io/chunk_codec.h"
#include "io/chunk_source.h"
#include "io/h5.h"

namespace landfall {

/// Rows of a chunk of a table column.
inline constexpr std::size_t kTableChunkRows = 65536;

struct ColumnSpec {
  std::string name;
  h5::Type type;
  std::string units;
  std::string long_name;
  std::vector<std::int8_t> flag_values = {};  ///< with flag_meanings: a CF flag variable
  std::string flag_meanings = {};
};

/// One column's new rows. Doubles may go into a float32 column; other types must match.
using ColumnRows = std::variant<std::span<const double>, std::span<const std::int64_t>,
                                std::span<const std::int32_t>, std::span<const std::int8_t>>;

class TableReader;

/// A group of 1-D columns of equal length that grows row by row in bounded memory. Full chunks are compressed
/// in parallel and written in order; the bytes do not depend on how the rows were batched.
class TableWriter {
 public:
  TableWriter(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns, int compression);

  /// From now on the columns named are copied chunk by chunk, as `source` stores them, and append() leaves
  /// their rows aside: for columns that are known to come out the same as in an earlier file. Call before the
  /// first append; `source` must live until finish(), which throws FormatError unless it has as many rows. A
  /// column that is stored otherwise there, in type, chunks or filters, is written as before.
  void copy_columns(const TableReader& source, std::span<const char* const> names);

  /// Adds rows; `rows` in the order of the columns, all of one length. Throws IoError when the disk refuses,
  /// FormatError where a column to copy cannot be read. Uses HDF5 under h5::library_lock().
  void append(std::span<const ColumnRows> rows);
  /// Writes what is buffered. Call once, after the last append.
  void finish();

  [[nodiscard]] std::size_t row_count() const { return written_rows_ + buffered_rows_; }
  [[nodiscard]] hid_t group() const { return group_.get(); }

 private:
  struct Column {
    ColumnSpec spec;
    h5::Handle dataset;
    std::vector<std::byte> buffer;
    ChunkEncoder encoder;
    h5::Handle copied_from{};  ///< the dataset whose chunks this column takes
  };
  [[nodiscard]] std::span<const std::byte> copied_chunk(const Column& column);
  void require_whole_copies() const;
  void buffer_rows(std::span<const ColumnRows> rows, std::size_t begin, std::size_t count);
  void flush();

  int compression_;
  h5::Handle group_;
  std::vector<Column> columns_;
  const TableReader* source_ = nullptr;  ///< of copied columns
  StoredChunk copied_;                   ///< the last one
  std::size_t buffered_rows_ = 0;
  std::size_t written_rows_ = 0;
};

/// Writes whole columns at once.
void write_table(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns,
                 std::span<const ColumnRows> rows, int compression);

/// Reads 1-D columns of equal length, in pieces of rows.
class TableReader {
 public:
  /// Throws FormatError (naming `file`) where the group is missing.
  TableReader(hid_t parent, const std::string& group, std::string file);

  [[nodiscard]] bool has(const std::string& column) const;
  /// The rows of a column; every column read must have the same number. Throws FormatError where it is
  /// missing or is not 1-D.
  [[nodiscard]] std::size_t row_count(const std::string& column) const;
  /// Bytes of one value as stored.
  [[nodiscard]] std::size_t element_size(const std::string& column) const;
  /// Reads rows [begin, begin + out.size()) converted to T, as ColumnReader does; for many pieces of a column
  /// use that one.
  template <class T>
  void read(const std::string& column, std::size_t begin, std::span<T> out) const;
  /// The column's dataset. Throws FormatError where it is missing.
  [[nodiscard]] h5::Handle open(const std::string& column) const;
  [[nodiscard]] hid_t group() const { return group_.get(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  /// "/group/column", for messages.
  [[nodiscard]] std::string path_of(const std::string& column) const { return name_ + "/" + column; }
  /// "file: reading /group/column failed: why"; by default why is HDF5's own reason.
  [[noreturn]] void fail_reading(const std::string& column, std::string why = {}) const;

 private:
  std::string file_;
  std::string name_;
  h5::Handle group_;
};

}  // namespace landfall
