// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_source.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <functional>
#include <numeric>

#include "store/hdf5/h5_filters.h"

namespace landfall {
namespace {

std::optional<h5::Type> stored_type(hid_t dataset) {
  if constexpr (std::endian::native != std::endian::little) return std::nullopt;
  const h5::Handle type(H5Dget_type(dataset), H5Tclose);
  return h5::type_of(type.get());
}

bool has_chunks(hid_t properties, std::span<const hsize_t> chunk) {
  if (H5Pget_layout(properties) != H5D_CHUNKED) return false;
  std::vector<hsize_t> found(H5S_MAX_RANK, 0);
  const int rank = H5Pget_chunk(properties, H5S_MAX_RANK, found.data());
  return rank == static_cast<int>(chunk.size()) && std::equal(chunk.begin(), chunk.end(), found.begin());
}

std::optional<ChunkFilters> our_filters(hid_t properties) {
  const std::vector<h5::Filter> filters = h5::filters_in(properties);
  if (filters.empty()) return ChunkFilters::none;
  if (filters.size() == 1 && filters[0].id == H5Z_FILTER_FLETCHER32) return ChunkFilters::fletcher32;
  if (filters.size() == 1 && filters[0].id == H5Z_FILTER_DEFLATE) return ChunkFilters::deflate;
  if (filters.size() == 2 && filters[0].id == H5Z_FILTER_SHUFFLE && filters[1].id == H5Z_FILTER_DEFLATE)
    return ChunkFilters::shuffle_deflate;
  return std::nullopt;
}

/// Whether the file can hold so many bytes: a damaged size must not cost memory.
bool is_stored(hid_t dataset, hsize_t size) {
  const h5::Handle file(H5Iget_file_id(dataset), H5Fclose);
  hsize_t file_size = 0;
  return H5Fget_filesize(file.get(), &file_size) >= 0 && size <= file_size;
}

bool read_fully(int descriptor, std::uint64_t offset, std::span<std::byte> out) {
  while (!out.empty()) {
    const ssize_t count = ::pread(descriptor, out.data(), out.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    out = out.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return true;
}

}  // namespace

std::optional<DecodableChunks> decodable_chunks(hid_t dataset, std::span<const hsize_t> chunk) {
  const h5::Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (!has_chunks(properties.get(), chunk)) return std::nullopt;
  const std::optional<ChunkFilters> filters = our_filters(properties.get());
  const std::optional<h5::Type> type = stored_type(dataset);
  if (!filters || !type) return std::nullopt;
  const auto count = std::accumulate(chunk.begin(), chunk.end(), hsize_t{1}, std::multiplies<>());
  return DecodableChunks{*type, {h5::size_of(*type), static_cast<std::size_t>(count), *filters}};
}

bool load_chunk(hid_t dataset, std::span<const hsize_t> offset, StoredChunk& chunk) {
  hsize_t size = 0;
  if (H5Dget_chunk_storage_size(dataset, offset.data(), &size) < 0 || size == 0 || !is_stored(dataset, size))
    return false;
  chunk.bytes.resize(size);
  return H5Dread_chunk(dataset, H5P_DEFAULT, offset.data(), &chunk.filter_mask, chunk.bytes.data()) >= 0;
}

bool ChunkFile::load(hid_t dataset, std::span<const hsize_t> offset, StoredChunk& chunk) const {
  haddr_t address = HADDR_UNDEF;
  hsize_t size = 0;
  {
    const std::lock_guard lock(h5::library_lock());
    if (!descriptor_) return load_chunk(dataset, offset, chunk);
    if (H5Dget_chunk_info_by_coord(dataset, offset.data(), &chunk.filter_mask, &address, &size) < 0 ||
        address == HADDR_UNDEF || size == 0 || !is_stored(dataset, size))
      return false;
  }
  chunk.bytes.resize(size);
  return read_fully(*descriptor_, address, chunk.bytes);
}

}  // namespace landfall
