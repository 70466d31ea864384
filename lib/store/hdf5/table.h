// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "store/hdf5/chunk_codec.h"
#include "store/hdf5/chunk_source.h"
#include "store/hdf5/h5.h"

namespace landfall {

/// Rows per chunk of a table column; a shorter table has one chunk, of all its rows.
inline constexpr std::size_t kTableChunkRows = 65536;
/// Rows of a long table that are read at a time, 15 MB of a scan.
inline constexpr std::size_t kBatchRows = 4 * kTableChunkRows;

/// How the chunks of a column with so many rows can be decoded without HDF5; nothing for chunks of other
/// sizes, which other programs may write. Short tables of earlier versions have chunks of kTableChunkRows
/// too.
[[nodiscard]] std::optional<DecodableChunks> decodable_column(hid_t dataset, std::size_t rows);

/// A column of a table. `units` and `long_name` become its attributes.
struct ColumnSpec {
  std::string name;
  h5::Type type;
  std::string units;
  std::string long_name;
  std::vector<std::int8_t> flag_values = {};  ///< with flag_meanings: a CF flag variable
  std::string flag_meanings = {};
};

/// The new rows of one column. Doubles may go into a float32 column; other types must match.
using ColumnRows =
    std::variant<std::span<const double>, std::span<const float>, std::span<const std::int64_t>,
                 std::span<const std::int32_t>, std::span<const std::int8_t>>;

class TableReader;

/// Rows that make one chunk of every column, before they are written to the file.
struct TableChunk {
  /// The part of one column.
  struct Part {
    std::vector<std::byte> rows;
    ChunkEncoder encoder;
    StoredChunk copy;                   ///< the source's chunk, for a copied column
    std::span<const std::byte> stored;  ///< bytes to store, set by encode()
  };
  std::size_t first_row = 0;
  std::size_t row_count = 0;
  std::vector<Part> parts;
};

/// A group of 1-D columns of equal length that grows row by row in bounded memory. The file's bytes do not
/// depend on how the rows were batched.
///
/// A pipeline takes rows, encodes the chunks that they fill and writes those. take() and write() are each
/// called by one thread at a time and in order, encode() by any thread; all three may run at the same time.
/// append() does all three. HDF5 is used under h5::library_lock().
class TableWriter {
 public:
  using ChunkPtr = std::shared_ptr<TableChunk>;

  /// Creates the group `group` of `parent`; its columns are created when the first chunk is written, or by
  /// finish(). `compression`: deflate level, 0..9.
  TableWriter(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns, int compression);

  /// Copies the named columns from `source` chunk by chunk, as stored; take() ignores their rows, which may
  /// be empty, except those of the first column, which count. For columns that are known to equal those of an
  /// earlier file. Call before the first rows; throws FormatError if columns of `source` differ in length, as
  /// finish(), until which it must live, if this table does. A column whose type, chunks or filters differ in
  /// `source` is not copied but written from its rows; returns false if there is such a column.
  bool copy_columns(const TableReader& source, std::span<const char* const> names);

  /// Adds rows: one element of `rows` for each column, in their order, all of one length. Returns the chunks
  /// that became full, to be encoded and written.
  [[nodiscard]] std::vector<ChunkPtr> take(std::span<const ColumnRows> rows);
  /// Compresses on all threads. Throws FormatError if a column to copy cannot be read, or a value is
  /// infinite.
  void encode(TableChunk& chunk) const;
  /// Throws IoError when writing fails.
  void write(ChunkPtr chunk);
  /// take(), encode() and write().
  void append(std::span<const ColumnRows> rows);
  /// Writes the remaining rows. Call once, after everything else.
  void finish();

  /// Rows taken.
  [[nodiscard]] std::size_t row_count() const { return row_count_; }
  [[nodiscard]] hid_t group() const { return group_.get(); }

 private:
  struct Column {
    ColumnSpec spec;
    h5::Handle dataset{};
    h5::Handle copied_from{};  ///< the dataset whose chunks this column takes
    std::size_t source_rows = 0;
  };
  [[nodiscard]] ChunkPtr empty_chunk();
  void add_rows(std::span<const ColumnRows> rows, std::size_t begin, std::size_t count);
  void create_columns(std::size_t chunk_rows);
  [[nodiscard]] bool is_stored_alike(hid_t theirs, std::size_t rows, h5::Type type) const;
  void load_copy(const Column& column, const TableChunk& chunk, StoredChunk& copy) const;
  void require_whole_copies() const;

  int compression_;
  h5::Handle group_;
  std::optional<int> descriptor_;
  std::vector<Column> columns_;
  const TableReader* source_ = nullptr;  ///< source of copied columns
  std::optional<ChunkFile> source_file_;
  ChunkPtr filling_;
  std::size_t row_count_ = 0;
  std::mutex free_mutex_;
  std::vector<ChunkPtr> free_;  ///< already written; their memory is reused
};

/// Writes a table whose rows are all known: TableWriter in one call.
void write_table(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns,
                 std::span<const ColumnRows> rows, int compression);

/// Names the dimension of a table's rows: the columns of `group` share the dimension scale `dimension` of
/// `root`, which holds no values (in netCDF: a dimension without a variable). Does nothing for more than 2^28
/// rows, because screen_file() (file_screening.h) refuses so large a dataset without values.
void name_rows(hid_t root, const std::string& group, const std::string& dimension);

/// Reads 1-D columns of equal length, in pieces of rows.
class TableReader {
 public:
  /// Throws FormatError (naming `file`) if the group is missing.
  TableReader(hid_t parent, const std::string& group, std::string file);

  [[nodiscard]] bool has(const std::string& column) const;
  /// The number of rows of a column; it must be equal for all columns that are read. Throws FormatError if
  /// the column is missing or not 1-D.
  [[nodiscard]] std::size_t row_count(const std::string& column) const;
  /// Stored size of one value, bytes.
  [[nodiscard]] std::size_t element_size(const std::string& column) const;
  /// Reads rows [begin, begin + out.size()) converted to T, as ColumnReader does. To read a column in many
  /// pieces use ColumnReader.
  template <class T>
  void read(const std::string& column, std::size_t begin, std::span<T> out) const;
  /// The column's dataset. Throws FormatError if it is missing.
  [[nodiscard]] h5::Handle open(const std::string& column) const;
  [[nodiscard]] hid_t group() const { return group_.get(); }
  [[nodiscard]] const std::string& file() const { return file_; }
  /// "/group/column", for messages.
  [[nodiscard]] std::string path_of(const std::string& column) const { return name_ + "/" + column; }
  /// "file: reading /group/column failed: why"; by default, why is HDF5's own reason.
  [[noreturn]] void fail_reading(const std::string& column, std::string why = {}) const;

 private:
  std::string file_;
  std::string name_;
  h5::Handle group_;
};

}  // namespace landfall
