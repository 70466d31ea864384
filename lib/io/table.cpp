// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/table.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "io/chunk_source.h"
#include "io/column_reader.h"

namespace landfall {
namespace {

std::size_t length(const ColumnRows& rows) {
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

/// The level of a dataset whose chunks are as TableWriter's: 0 for plain ones.
std::optional<unsigned> deflate_level(hid_t dataset, const DecodableChunks& chunks) {
  if (!chunks.format.filtered) return 0;
  const h5::Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  unsigned level = 0;
  unsigned flags = 0;
  std::size_t value_count = 1;
  if (H5Pget_filter_by_id2(properties.get(), H5Z_FILTER_DEFLATE, &flags, &value_count, &level, 0, nullptr,
                           nullptr) < 0)
    return std::nullopt;
  return level;
}

/// True where two datasets store equal values as equal chunks.
bool stored_alike(hid_t a, hid_t b) {
  constexpr std::array<hsize_t, 1> kChunk = {kTableChunkRows};
  const std::optional<DecodableChunks> in_a = decodable_chunks(a, kChunk);
  const std::optional<DecodableChunks> in_b = decodable_chunks(b, kChunk);
  return in_a && in_b && in_a->type == in_b->type && deflate_level(a, *in_a) == deflate_level(b, *in_b);
}

void write_chunk(hid_t dataset, std::size_t begin, std::size_t end, std::span<const std::byte> bytes,
                 const std::string& name) {
  const hsize_t size = end;
  const hsize_t offset = begin;
  if (H5Dset_extent(dataset, &size) < 0 ||
      H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, &offset, bytes.size(), bytes.data()) < 0)
    throw IoError("writing column " + name + " failed: " + h5::failure_reason());
}

void describe(hid_t dataset, const ColumnSpec& spec) {
  h5::write_attribute(dataset, "units", spec.units);
  h5::write_attribute(dataset, "long_name", spec.long_name);
  if (spec.flag_values.empty()) return;
  h5::write_attribute(dataset, "flag_values", spec.flag_values);
  h5::write_attribute(dataset, "flag_meanings", spec.flag_meanings);
}

}  // namespace

TableWriter::TableWriter(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns,
                         int compression)
    : compression_(compression), group_(h5::create_group(parent, group)) {
  for (ColumnSpec& spec : columns) {
    h5::Handle dataset =
        h5::create_dataset(group_.get(), spec.name, spec.type,
                           {.size = {0}, .chunk = {kTableChunkRows}, .growing = true, .level = compression_});
    describe(dataset.get(), spec);
    std::vector<std::byte> buffer(kTableChunkRows * h5::size_of(spec.type));
    const ChunkEncoder encoder(h5::size_of(spec.type), compression_);
    columns_.push_back({std::move(spec), std::move(dataset), std::move(buffer), encoder});
  }
}

void TableWriter::copy_columns(const TableReader& source, std::span<const char* const> names) {
  source_ = &source;
  for (Column& column : columns_) {
    if (std::find(names.begin(), names.end(), column.spec.name) == names.end()) continue;
    h5::Handle theirs = source.open(column.spec.name);
    if (stored_alike(theirs.get(), column.dataset.get())) column.copied_from = std::move(theirs);
  }
}

void TableWriter::append(std::span<const ColumnRows> rows) {
  if (rows.size() != columns_.size()) throw std::logic_error("a table row needs every column");
  const std::size_t count = length(rows.front());
  std::size_t begin = 0;
  while (begin < count) {
    const std::size_t take = std::min(count - begin, kTableChunkRows - buffered_rows_);
    buffer_rows(rows, begin, take);
    begin += take;
    if (buffered_rows_ == kTableChunkRows) flush();
  }
}

void TableWriter::buffer_rows(std::span<const ColumnRows> rows, std::size_t begin, std::size_t count) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Column& column = columns_[c];
    if (column.copied_from) continue;
    std::byte* const target = column.buffer.data() + buffered_rows_ * h5::size_of(column.spec.type);
    std::visit([&](auto span) { copy_rows(span.subspan(begin, count), column.spec.type, target); }, rows[c]);
  }
  buffered_rows_ += count;
}

void TableWriter::flush() {
  std::vector<std::span<const std::byte>> encoded(columns_.size());
  parallel_for(columns_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      if (!columns_[c].copied_from) encoded[c] = columns_[c].encoder.encode(columns_[c].buffer);
  });
  const std::lock_guard lock(h5::library_lock());
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    write_chunk(column.dataset.get(), written_rows_, written_rows_ + buffered_rows_,
                column.copied_from ? copied_chunk(column) : encoded[c], column.spec.name);
  }
  h5::start_writeback(group_.get());
  written_rows_ += buffered_rows_;
  buffered_rows_ = 0;
}

std::span<const std::byte> TableWriter::copied_chunk(const Column& column) {
  const std::array<hsize_t, 1> offset = {written_rows_};
  if (written_rows_ >= source_->row_count(column.spec.name))
    source_->fail_reading(column.spec.name, "it ends after " + std::to_string(written_rows_) + " rows");
  if (!load_chunk(column.copied_from.get(), offset, copied_) || copied_.filter_mask != 0)
    source_->fail_reading(column.spec.name);
  return copied_.bytes;
}

void TableWriter::require_whole_copies() const {
  for (const Column& column : columns_) {
    if (!column.copied_from) continue;
    const std::size_t rows = source_->row_count(column.spec.name);
    if (rows != row_count())
      source_->fail_reading(column.spec.name, "it has " + std::to_string(rows) + " rows where " +
                                                  std::to_string(row_count()) + " are needed");
  }
}

void TableWriter::finish() {
  require_whole_copies();
  if (buffered_rows_ == 0) return;
  for (Column& column : columns_) {  // the unused end of the last chunk: zeros, never old rows
    if (column.copied_from) continue;
    const std::size_t used = buffered_rows_ * h5::size_of(column.spec.type);
    std::fill(column.buffer.begin() + static_cast<std::ptrdiff_t>(used), column.buffer.end(), std::byte{0});
  }
  flush();
}

void write_table(hid_t parent, const std::string& group, std::vector<ColumnSpec> columns,
                 std::span<const ColumnRows> rows, int compression) {
  TableWriter table(parent, group, std::move(columns), compression);
  table.append(rows);
  table.finish();
}

TableReader::TableReader(hid_t parent, const std::string& group, std::string file)
    : file_(std::move(file)), name_(group == "/" ? "" : "/" + group) {
  group_ = h5::Handle(H5Gopen2(parent, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group_) throw FormatError(file_ + ": no group " + (name_.empty() ? "/" : name_));
}

bool TableReader::has(const std::string& column) const { return h5::exists(group_.get(), column); }

h5::Handle TableReader::open(const std::string& column) const {
  h5::Handle dataset;
  if (has(column)) dataset = h5::Handle(H5Dopen2(group_.get(), column.c_str(), H5P_DEFAULT), H5Dclose);
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
  if (why.empty()) why = h5::failure_reason();
  throw FormatError(file_ + ": reading " + path_of(column) + " failed" + (why.empty() ? "" : ": " + why));
}

template void TableReader::read(const std::string&, std::size_t, std::span<double>) const;
template void TableReader::read(const std::string&, std::size_t, std::span<std::int64_t>) const;
template void TableReader::read(const std::string&, std::size_t, std::span<std::int32_t>) const;
template void TableReader::read(const std::string&, std::size_t, std::span<std::int8_t>) const;

}  // namespace landfall
