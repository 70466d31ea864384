// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "store/hdf5/chunk_source.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/memory_file.h"

namespace landfall {

class TableReader;

/// The destination of the rows of one column.
using ColumnTarget =
    std::variant<std::span<double>, std::span<std::int64_t>, std::span<std::int32_t>, std::span<std::int8_t>>;

/// Columns of a table, opened once and read batch by batch.
///
/// Chunks in the form that TableWriter writes are decoded in parallel, also float32 into double; HDF5 only
/// provides their bytes. Columns in any other form (contiguous, big-endian, other filters, chunks or types)
/// are read by h5::read_values(), which is slower. The chunk in which a batch ends is kept, so that
/// batches in order decode every chunk once for any batch size: up to 512 KiB per column.
class ColumnReader {
 public:
  /// Throws FormatError, naming file and column, if a column is missing or not one-dimensional. The
  /// table's file must stay open.
  ColumnReader(const TableReader& table, const std::vector<std::string>& columns);

  /// Reads rows [begin, begin + length) of every column, converted to the type of its target; `targets` are
  /// in the order of the columns, all of one length. Throws FormatError, naming file and column, for rows
  /// beyond the end, for a chunk that is corrupt or has the wrong size, and if HDF5 fails. Uses HDF5 under
  /// h5::library_lock(), from several threads.
  void read(std::size_t begin, std::span<const ColumnTarget> targets);

 private:
  struct Column {
    std::string name;  ///< for messages: "file: ... /group/name"
    h5::Handle dataset;
    ChunkFile file;
    std::size_t row_count;
    std::optional<DecodableChunks> chunks;
    std::shared_ptr<const h5::MemoryArray> array;  ///< null unless the values are in memory
    std::optional<std::size_t> kept_chunk;         ///< the chunk that `kept` holds, decoded
    std::vector<std::byte> kept;
  };
  /// The part of a chunk that a batch needs.
  struct Piece {
    std::size_t column;
    std::size_t chunk;
    std::size_t first;  ///< row in the chunk
    std::size_t count;
    bool keep;
  };

  [[nodiscard]] std::vector<Piece> pieces(std::size_t begin, std::span<const ColumnTarget> targets) const;
  /// False if the piece's chunk is not the kept one.
  bool copy_kept(const Piece& piece, const ColumnTarget& target) const;
  void read_piece(const Piece& piece, const ColumnTarget& target);
  void read_plainly(const Column& column, std::size_t begin, const ColumnTarget& target) const;
  [[noreturn]] void fail(const Column& column, const std::string& why) const;

  std::string file_;
  std::vector<Column> columns_;
};

}  // namespace landfall
