// SPDX-License-Identifier: GPL-3.0-or-later
// Named dimensions of tables lie at the root and hold no values. In the group itself they would be one
// more column to everyone who reads all of them. Values would be row numbers. Scans of more than 2^28
// points have none, because a dataset that declares more than 256 MiB without storing them is refused as
// damaged.
#include "store/hdf5/table.h"

#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "store/hdf5/chunk_source.h"
#include "store/hdf5/column_reader.h"
#include "store/hdf5/dataset_list.h"
#include "store/hdf5/h5_filters.h"
#include "store/hdf5/infinite_values.h"
#include "store/hdf5/memory_file.h"

namespace landfall {
namespace {

std::size_t rows_in(const ColumnRows& rows) {
  return std::visit([](auto span) { return span.size(); }, rows);
}

template <class T>
void copy_rows(std::span<const T> from, h5::Type to_type, std::byte* to) {
  if constexpr (std::is_same_v<T, double>) {
    if (to_type == h5::Type::float32) {
      for (std::size_t i = 0; i < from.size(); ++i) {
        const auto value = static_cast<float>(from[i]);
        std::memcpy(to + i * sizeof value, &value, sizeof value);
      }
      return;
    }
  }
  if (h5::TypeOf<T>::value != to_type) throw std::logic_error("a column's rows are not of its type");
  std::memcpy(to, from.data(), from.size_bytes());
}

void require_rows(const TableReader& source, const std::string& column, std::size_t found,
                  std::size_t needed) {
  if (found != needed)
    source.fail_reading(
        column, "it has " + std::to_string(found) + " rows where " + std::to_string(needed) + " are needed");
}

std::size_t chunk_rows_of(std::size_t rows) {
  return rows == 0 ? kTableChunkRows : std::min(rows, kTableChunkRows);
}

void write_chunk(hid_t dataset, std::size_t begin, std::size_t end, std::span<const std::byte> bytes,
                 const std::string& name) {
  const hsize_t size = end;
  const std::array<hsize_t, 1> offset = {begin};
  if (H5Dset_extent(dataset, &size) < 0 || !h5::write_chunk(dataset, offset, bytes))
    throw IoError("writing column " + name + " failed: " + h5::failure_reason());
}

void describe_column(hid_t dataset, const ColumnSpec& spec) {
  h5::write_attribute(dataset, "units", spec.units);
  h5::write_attribute(dataset, "long_name", spec.long_name);
  if (spec.flag_values.empty()) return;
  h5::write_attribute(dataset, "flag_values", spec.flag_values);
  h5::write_attribute(dataset, "flag_meanings", spec.flag_meanings);
}

void add_dimension(hid_t root, const std::string& group, const std::string& dimension) {
  constexpr hsize_t kMaxRows = hsize_t{1} << 28U;
  const h5::Handle columns = h5::open_group(root, group);
  const std::vector<DatasetEntry> entries = list_datasets(columns.get());
  const hsize_t rows = entries.at(0).shape.at(0);
  if (rows > kMaxRows) return;
  const h5::Handle scale = h5::create_dataset(root, dimension, h5::Type::int8, {.size = {rows}, .chunk = {}});
  h5::write_attribute(scale.get(), "units", std::string("1"));
  h5::write_attribute(scale.get(), "long_name", "rows of /" + group);
  // netCDF knows a dimension without a variable by this name; the number fills the width that it writes.
  std::array<char, 80> name{};
  std::snprintf(name.data(), name.size(), "This is a netCDF dimension but not a netCDF variable.%10llu",
                static_cast<unsigned long long>(rows));
  bool attached = H5DSset_scale(scale.get(), name.data()) >= 0;
  for (const DatasetEntry& entry : entries)
    attached = attached && H5DSattach_scale(entry.dataset.get(), scale.get(), 0) >= 0;
  if (!attached) throw IoError("attaching the dimension " + dimension + " failed: " + h5::failure_reason());
}

}  // namespace

std::optional<DecodableChunks> decodable_column(hid_t dataset, std::size_t rows) {
  for (const hsize_t chunk : {hsize_t{chunk_rows_of(rows)}, hsize_t{kTableChunkRows}})
    if (auto chunks = decodable_chunks(dataset, std::span(&chunk, 1))) return chunks;
  return std::nullopt;
}

TableWriter::TableWriter(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns,
                         int compression)
    : compression_(compression),
      group_(h5::create_group(parent, group)),
      descriptor_(h5::descriptor(parent)) {
  for (ColumnSpec& spec : columns) columns_.push_back({std::move(spec)});
}

void TableWriter::create_columns(std::size_t chunk_rows) {
  for (Column& column : columns_) {
    column.dataset =
        h5::create_dataset(group_.get(), column.spec.name, column.spec.type,
                           {.size = {0}, .chunk = {chunk_rows}, .growing = true, .level = compression_});
    describe_column(column.dataset.get(), column.spec);
  }
}

/// Whether a dataset of so many rows holds the chunks that this table would write.
bool TableWriter::is_stored_alike(hid_t theirs, std::size_t rows, h5::Type type) const {
  if (compression_ == h5::kPlain || h5::MemoryFile::of(theirs) != nullptr) return false;
  const std::array<hsize_t, 1> chunk = {chunk_rows_of(rows)};
  const std::optional<DecodableChunks> chunks = decodable_chunks(theirs, chunk);
  const ChunkFilters filters = compression_ == 0 ? ChunkFilters::deflate : ChunkFilters::shuffle_deflate;
  return chunks && chunks->type == type && chunks->format.filters == filters &&
         h5::deflate_level(theirs) == compression_;
}

bool TableWriter::copy_columns(const TableReader& source, std::span<const char* const> names) {
  source_ = &source;
  source_file_.emplace(source.group());
  const std::string& first = columns_.front().spec.name;
  bool all = true;
  for (Column& column : columns_) {
    if (std::find(names.begin(), names.end(), column.spec.name) == names.end()) continue;
    h5::Handle theirs = source.open(column.spec.name);
    const std::size_t rows = source.row_count(column.spec.name);
    require_rows(source, column.spec.name, rows, source.has(first) ? source.row_count(first) : rows);
    if (is_stored_alike(theirs.get(), rows, column.spec.type)) {
      column.copied_from = std::move(theirs);
      column.source_rows = rows;
    } else {
      all = false;
    }
  }
  return all;
}

TableWriter::ChunkPtr TableWriter::empty_chunk() {
  {
    const std::lock_guard lock(free_mutex_);
    if (!free_.empty()) {
      ChunkPtr chunk = std::move(free_.back());
      free_.pop_back();
      return chunk;
    }
  }
  auto chunk = std::make_shared<TableChunk>();
  for (const Column& column : columns_) {
    chunk->parts.push_back({{}, ChunkEncoder(h5::size_of(column.spec.type), compression_), {}, {}});
  }
  return chunk;
}

std::vector<TableWriter::ChunkPtr> TableWriter::take(std::span<const ColumnRows> rows) {
  if (rows.size() != columns_.size()) throw std::logic_error("a table row needs every column");
  std::vector<ChunkPtr> full;
  const std::size_t count = rows_in(rows.front());
  for (std::size_t begin = 0; begin < count;) {
    if (!filling_) {
      filling_ = empty_chunk();
      filling_->first_row = row_count_;
      filling_->row_count = 0;
    }
    const std::size_t size = std::min(count - begin, kTableChunkRows - filling_->row_count);
    add_rows(rows, begin, size);
    begin += size;
    if (filling_->row_count == kTableChunkRows) full.push_back(std::exchange(filling_, nullptr));
  }
  return full;
}

void TableWriter::add_rows(std::span<const ColumnRows> rows, std::size_t begin, std::size_t count) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].copied_from) continue;
    const h5::Type type = columns_[c].spec.type;
    std::vector<std::byte>& bytes = filling_->parts[c].rows;
    const std::size_t used = filling_->row_count * h5::size_of(type);
    bytes.resize(std::max(bytes.size(), used + count * h5::size_of(type)));
    std::visit([&](auto span) { copy_rows(span.subspan(begin, count), type, bytes.data() + used); }, rows[c]);
  }
  filling_->row_count += count;
  row_count_ += count;
}

void TableWriter::encode(TableChunk& chunk) const {
  parallel_for(columns_.size(), 1, [&](std::size_t c, std::size_t) {
    TableChunk::Part& part = chunk.parts[c];
    if (columns_[c].copied_from) {
      load_copy(columns_[c], chunk, part.copy);
      part.stored = part.copy.bytes;
    } else {
      require_no_infinity(part.rows, columns_[c].spec.type, "column " + columns_[c].spec.name);
      part.stored = part.encoder.encode(part.rows);
    }
  });
}

void TableWriter::write(ChunkPtr chunk) {
  {
    const std::lock_guard lock(h5::library_lock());
    if (chunk->first_row == 0) create_columns(chunk_rows_of(chunk->row_count));
    for (std::size_t c = 0; c < columns_.size(); ++c)
      write_chunk(columns_[c].dataset.get(), chunk->first_row, chunk->first_row + chunk->row_count,
                  chunk->parts[c].stored, columns_[c].spec.name);
  }
  if (descriptor_) h5::start_writeback(*descriptor_);
  const std::lock_guard lock(free_mutex_);
  free_.push_back(std::move(chunk));
}

void TableWriter::append(std::span<const ColumnRows> rows) {
  for (ChunkPtr& chunk : take(rows)) {
    encode(*chunk);
    write(std::move(chunk));
  }
}

void TableWriter::load_copy(const Column& column, const TableChunk& chunk, StoredChunk& copy) const {
  const std::array<hsize_t, 1> offset = {chunk.first_row};
  const bool exists = chunk.first_row < column.source_rows;
  if (exists && source_file_->load(column.copied_from.get(), offset, copy) && copy.filter_mask == 0) return;
  const std::lock_guard lock(h5::library_lock());
  if (exists) source_->fail_reading(column.spec.name);
  source_->fail_reading(column.spec.name, "it ends after " + std::to_string(chunk.first_row) + " rows");
}

void TableWriter::require_whole_copies() const {
  for (const Column& column : columns_) {
    if (column.copied_from) require_rows(*source_, column.spec.name, column.source_rows, row_count_);
  }
}

void TableWriter::finish() {
  require_whole_copies();
  if (row_count_ == 0) {
    const std::lock_guard lock(h5::library_lock());
    create_columns(chunk_rows_of(0));
  }
  if (!filling_) return;
  const std::size_t chunk_rows = chunk_rows_of(row_count_);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].copied_from) continue;
    const std::size_t size = h5::size_of(columns_[c].spec.type);
    filling_->parts[c].rows.resize(filling_->row_count * size);
    filling_->parts[c].rows.resize(chunk_rows * size);  // with zeros instead of old rows
  }
  encode(*filling_);
  write(std::exchange(filling_, nullptr));
}

void write_table(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns,
                 std::span<const ColumnRows> rows, int compression) {
  TableWriter table(parent, group, std::move(columns), compression);
  table.append(rows);
  table.finish();
}

void name_rows(hid_t root, const std::string& group, const std::string& dimension) {
  h5::for_other_programs(root, [=](hid_t file) { add_dimension(file, group, dimension); });
}

TableReader::TableReader(hid_t parent, const std::string& group, std::string file)
    : file_(std::move(file)), name_(group == "/" ? "" : "/" + group), group_(h5::open_group(parent, group)) {
  if (!group_) throw FormatError(file_ + ": no group " + (name_.empty() ? "/" : name_));
}

bool TableReader::has(const std::string& column) const { return h5::exists(group_.get(), column); }

h5::Handle TableReader::open(const std::string& column) const {
  h5::Handle dataset = h5::open_dataset(group_.get(), column);
  if (!dataset) throw FormatError(file_ + ": no column " + path_of(column));
  return dataset;
}

std::size_t TableReader::row_count(const std::string& column) const {
  const h5::Handle dataset = open(column);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (H5Sget_simple_extent_ndims(space.get()) != 1)
    throw FormatError(file_ + ": column " + path_of(column) + " is not one-dimensional");
  return static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get()));
}

std::size_t TableReader::element_size(const std::string& column) const {
  const h5::Handle dataset = open(column);
  const h5::Handle type(H5Dget_type(dataset.get()), H5Tclose);
  return H5Tget_size(type.get());
}

template <class T>
void TableReader::read(const std::string& column, std::size_t begin, std::span<T> out) const {
  const std::array<ColumnTarget, 1> target = {out};
  ColumnReader(*this, {column}).read(begin, target);
}

void TableReader::fail_reading(const std::string& column, std::string why) const {
  if (why.empty()) why = h5::reading_failure();
  throw FormatError(file_ + ": reading " + path_of(column) + " failed" + (why.empty() ? "" : ": " + why));
}

template void TableReader::read(const std::string&, std::size_t, std::span<double>) const;
template void TableReader::read(const std::string&, std::size_t, std::span<std::int64_t>) const;
template void TableReader::read(const std::string&, std::size_t, std::span<std::int32_t>) const;
template void TableReader::read(const std::string&, std::size_t, std::span<std::int8_t>) const;

}  // namespace landfall
