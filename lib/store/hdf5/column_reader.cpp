// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/column_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

std::size_t length(const ColumnTarget& target) {
  return std::visit([](auto span) { return span.size(); }, target);
}

ColumnTarget part(const ColumnTarget& target, std::size_t first, std::size_t count) {
  return std::visit([=](auto span) { return ColumnTarget(span.subspan(first, count)); }, target);
}

h5::Type type_of(const ColumnTarget& target) {
  return std::visit([]<class T>(std::span<T>) { return h5::TypeOf<T>::value; }, target);
}

bool is_widened(h5::Type stored, const ColumnTarget& target) {
  return stored == h5::Type::float32 && type_of(target) == h5::Type::float64;
}

bool can_decode(const std::optional<DecodableChunks>& chunks, const ColumnTarget& target) {
  return chunks && (chunks->type == type_of(target) || is_widened(chunks->type, target));
}

std::span<std::byte> bytes_of(const ColumnTarget& target) {
  return std::visit([](auto span) { return std::as_writable_bytes(span); }, target);
}

void widen(std::span<const std::byte> floats, std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    float value = 0;
    std::memcpy(&value, floats.data() + i * sizeof value, sizeof value);
    out[i] = static_cast<double>(value);
  }
}

/// Converts elements of the stored type to that of the target.
void convert(std::span<const std::byte> elements, h5::Type stored, const ColumnTarget& target) {
  if (is_widened(stored, target)) {
    widen(elements, std::get<std::span<double>>(target));
  } else {
    std::memcpy(bytes_of(target).data(), elements.data(), elements.size());
  }
}

bool decode_into(const StoredChunk& stored, const DecodableChunks& chunks, std::size_t first,
                 const ColumnTarget& target) {
  if (!is_widened(chunks.type, target))
    return decode_chunk(stored.bytes, stored.filter_mask, chunks.format, first, bytes_of(target));
  thread_local std::vector<std::byte> floats;
  floats.resize(length(target) * sizeof(float));
  const bool ok = decode_chunk(stored.bytes, stored.filter_mask, chunks.format, first, floats);
  widen(floats, std::get<std::span<double>>(target));
  return ok;
}

}  // namespace

ColumnReader::ColumnReader(const TableReader& table, const std::vector<std::string>& columns)
    : file_(table.file()) {
  for (const std::string& name : columns) {
    const std::size_t row_count = table.row_count(name);
    h5::Handle dataset = table.open(name);
    const std::optional<DecodableChunks> chunks = decodable_column(dataset.get(), row_count);
    const ChunkFile file(dataset.get());
    const auto array = h5::array_in_memory(dataset.get());
    columns_.push_back({table.path_of(name), std::move(dataset), file, row_count, chunks, array, {}, {}});
  }
}

void ColumnReader::fail(const Column& column, const std::string& why) const {
  throw FormatError(file_ + ": reading " + column.name + " failed: " + why);
}

void ColumnReader::read(std::size_t begin, std::span<const ColumnTarget> targets) {
  if (targets.size() != columns_.size()) throw std::logic_error("every column needs a target");
  const std::size_t count = targets.empty() ? 0 : length(targets.front());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (length(targets[c]) != count) throw std::logic_error("columns are read by equal numbers of rows");
    if (begin > columns_[c].row_count || count > columns_[c].row_count - begin)
      fail(columns_[c], "row " + std::to_string(begin + count) + " is beyond its end");
  }
  if (count == 0) return;
  std::vector<Piece> todo = pieces(begin, targets);
  const auto target_of = [&](const Piece& piece) {
    return part(targets[piece.column], piece.chunk * kTableChunkRows + piece.first - begin, piece.count);
  };
  // Copy the kept chunk first, because another piece may replace it.
  std::erase_if(todo, [&](const Piece& piece) { return copy_kept(piece, target_of(piece)); });
  parallel_for(todo.size(), 1, [&](std::size_t i, std::size_t) { read_piece(todo[i], target_of(todo[i])); });
  const std::lock_guard lock(h5::library_lock());
  for (std::size_t c = 0; c < columns_.size(); ++c)
    if (!can_decode(columns_[c].chunks, targets[c])) read_plainly(columns_[c], begin, targets[c]);
}

std::vector<ColumnReader::Piece> ColumnReader::pieces(std::size_t begin,
                                                      std::span<const ColumnTarget> targets) const {
  std::vector<Piece> result;
  const std::size_t end = begin + length(targets.front());
  for (std::size_t chunk = begin / kTableChunkRows; chunk * kTableChunkRows < end; ++chunk) {
    const std::size_t first = std::max(begin, chunk * kTableChunkRows);
    const std::size_t last = std::min(end, (chunk + 1) * kTableChunkRows);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      // Only the last chunk of a batch can have rows for the next one.
      const bool keep = last == end && end < std::min((chunk + 1) * kTableChunkRows, columns_[c].row_count);
      if (can_decode(columns_[c].chunks, targets[c]))
        result.push_back({c, chunk, first - chunk * kTableChunkRows, last - first, keep});
    }
  }
  return result;
}

bool ColumnReader::copy_kept(const Piece& piece, const ColumnTarget& target) const {
  const Column& column = columns_[piece.column];
  if (column.kept_chunk != piece.chunk) return false;
  const std::size_t size = column.chunks->format.element_size;
  convert(std::span(column.kept).subspan(piece.first * size, piece.count * size), column.chunks->type,
          target);
  return true;
}

void ColumnReader::read_piece(const Piece& piece, const ColumnTarget& target) {
  Column& column = columns_[piece.column];
  const DecodableChunks& chunks = *column.chunks;
  if (column.array) {
    const std::size_t size = chunks.format.element_size;
    const std::span values(column.array->values.data(), column.array->values.size());
    const std::size_t first = piece.chunk * kTableChunkRows + piece.first;
    return convert(values.subspan(first * size, piece.count * size), chunks.type, target);
  }
  thread_local StoredChunk stored;
  const std::array<hsize_t, 1> offset = {piece.chunk * kTableChunkRows};
  if (!column.file.load(column.dataset.get(), offset, stored)) {
    const std::lock_guard lock(h5::library_lock());
    return read_plainly(column, piece.chunk * kTableChunkRows + piece.first, target);
  }
  bool ok = false;
  if (piece.keep) {
    column.kept_chunk.reset();
    column.kept.resize(chunks.format.byte_count());
    ok = decode_chunk(stored.bytes, stored.filter_mask, chunks.format, 0, column.kept);
  } else {
    ok = decode_into(stored, chunks, piece.first, target);
  }
  if (!ok) fail(column, "the chunk at row " + std::to_string(offset[0]) + " is corrupt");
  if (!piece.keep) return;
  column.kept_chunk = piece.chunk;
  copy_kept(piece, target);
}

void ColumnReader::read_plainly(const Column& column, std::size_t begin, const ColumnTarget& target) const {
  const std::array<hsize_t, 1> offset = {begin}, count = {length(target)};
  if (!h5::read_block(column.dataset.get(), h5::native(type_of(target)), offset, count,
                      bytes_of(target).data()))
    fail(column, h5::reading_failure());
}

}  // namespace landfall
