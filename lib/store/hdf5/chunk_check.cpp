// SPDX-License-Identifier: GPL-3.0-or-later
// Chunks are checked before H5Dread. libhdf5 1.10 does not check whether a chunk's filters produced all
// bytes of the chunk, and reads the missing bytes from the memory behind it (found by the fuzzer with
// AddressSanitizer). landfall decodes all tables and layers of its own files itself and checks this; data
// stored in another way is decoded once to check that it is complete, and then read by HDF5. Filters that
// landfall cannot decode are refused in landfall's files, but not in rasters, which GDAL reads.
#include "store/hdf5/chunk_check.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <mutex>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "store/hdf5/chunk_decoder.h"
#include "store/hdf5/chunk_filters.h"
#include "store/hdf5/chunk_source.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/h5_filters.h"

namespace landfall {
namespace {

std::vector<h5::Filter> filters_of(hid_t dataset) {
  const h5::Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  return h5::filters_in(properties.get());
}

/// The chunks of a dataset and those among them that a selection touches.
struct ChunkRange {
  std::vector<hsize_t> size;   ///< elements of a chunk per dimension; empty: the dataset has no chunks
  std::vector<hsize_t> first;  ///< numbers of the first chunk per dimension
  std::vector<hsize_t> last;
};

ChunkRange chunks_of(hid_t dataset, hid_t selection) {
  const h5::Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  const h5::Handle whole(H5Dget_space(dataset), H5Sclose);
  const hid_t space = selection == H5S_ALL ? whole.get() : selection;
  if (H5Pget_layout(properties.get()) != H5D_CHUNKED || H5Sget_select_npoints(space) <= 0) return {};
  const auto rank = static_cast<std::size_t>(H5Sget_simple_extent_ndims(space));
  ChunkRange range{std::vector<hsize_t>(rank), std::vector<hsize_t>(rank), std::vector<hsize_t>(rank)};
  H5Pget_chunk(properties.get(), static_cast<int>(rank), range.size.data());
  H5Sget_select_bounds(space, range.first.data(), range.last.data());
  for (std::size_t axis = 0; axis < rank; ++axis) {
    range.first[axis] /= range.size[axis];
    range.last[axis] /= range.size[axis];
  }
  return range;
}

/// Advances to the next chunk of a range, the last dimension first; false after the last one.
bool advance(std::vector<hsize_t>& chunk, const ChunkRange& range) {
  for (std::size_t axis = chunk.size(); axis-- > 0;) {
    if (chunk[axis]++ < range.last[axis]) return true;
    chunk[axis] = range.first[axis];
  }
  return false;
}

/// Remembers the large chunks of open files that are whole: a reader of parts meets them many times.
class LargeChunks {
 public:
  LargeChunks(hid_t dataset, std::size_t chunk_bytes) : are_large_(chunk_bytes > kSmall) {
    H5O_info_t info;
    if (are_large_ && H5Oget_info2(dataset, &info, H5O_INFO_BASIC) >= 0)
      object_ = {info.fileno, info.addr};  // HDF5 numbers each opening of a file
    else
      are_large_ = false;
  }
  [[nodiscard]] bool has(const std::vector<hsize_t>& offset) const {
    if (!are_large_) return false;
    const std::lock_guard lock(whole().lock);
    return whole().chunks.contains({object_, offset});
  }
  void add(const std::vector<hsize_t>& offset) const {
    if (!are_large_) return;
    const std::lock_guard lock(whole().lock);
    whole().chunks.insert({object_, offset});
  }

 private:
  static constexpr std::size_t kSmall = std::size_t{1} << 20U;
  using Object = std::pair<unsigned long, haddr_t>;
  struct Whole {
    std::mutex lock;
    std::set<std::pair<Object, std::vector<hsize_t>>> chunks;
  };
  static Whole& whole() {
    static Whole all;
    return all;
  }

  bool are_large_;
  Object object_{};
};

bool is_whole(const StoredChunk& stored, std::span<const h5::Filter> filters, std::size_t chunk_bytes) {
  const auto is_used = [&](std::size_t i) { return (stored.filter_mask >> i & 1U) == 0; };
  std::vector<std::byte> bytes = stored.bytes;
  for (std::size_t i = filters.size(); i-- > 0;) {
    if (!is_used(i) || filters[i].id == H5Z_FILTER_SHUFFLE) continue;
    if (filters[i].id == H5Z_FILTER_FLETCHER32) {
      if (bytes.size() < kFletcher32Bytes) return false;
      bytes.resize(bytes.size() - kFletcher32Bytes);
      continue;
    }
    std::size_t size = chunk_bytes;  // size before deflate
    for (std::size_t before = 0; before < i; ++before)
      if (is_used(before) && filters[before].id == H5Z_FILTER_FLETCHER32) size += kFletcher32Bytes;
    std::vector<std::byte> inflated(size);
    if (!decode_chunk(bytes, 1, {1, size, ChunkFilters::shuffle_deflate}, 0, inflated)) return false;
    bytes = std::move(inflated);
  }
  return bytes.size() == chunk_bytes;
}

}  // namespace

bool chunks_are_whole(hid_t dataset, hid_t selection) {
  const ChunkRange range = chunks_of(dataset, selection);
  if (range.size.empty()) return true;
  const std::vector<h5::Filter> filters = filters_of(dataset);
  const h5::Handle type(H5Dget_type(dataset), H5Tclose);
  std::size_t chunk_bytes = H5Tget_size(type.get());
  for (const hsize_t size : range.size) chunk_bytes *= size;
  std::vector<hsize_t> chunk = range.first;
  std::vector<hsize_t> offset(chunk.size());
  StoredChunk stored;
  LargeChunks known(dataset, chunk_bytes);
  do {
    std::ranges::transform(chunk, range.size, offset.begin(), std::multiplies<>());
    if (known.has(offset)) continue;
    if (load_chunk(dataset, offset, stored) && !is_whole(stored, filters, chunk_bytes)) return false;
    known.add(offset);
  } while (advance(chunk, range));
  return true;
}

ChunkBytes chunk_bytes_of(hid_t dataset) {
  const ChunkRange all = chunks_of(dataset, H5S_ALL);
  if (all.size.empty()) return {};
  const h5::Handle type(H5Dget_type(dataset), H5Tclose);
  ChunkBytes bytes{.one = static_cast<double>(H5Tget_size(type.get())), .row = 1};
  for (const hsize_t size : all.size) bytes.one *= static_cast<double>(size);
  for (std::size_t axis = 1; axis < all.last.size(); ++axis)
    bytes.row *= static_cast<double>(all.last[axis] + 1);
  bytes.row *= bytes.one;
  return bytes;
}

std::optional<std::string> undecodable_filter(hid_t dataset) {
  bool is_deflated = false;
  for (const h5::Filter& filter : filters_of(dataset)) {
    const bool keeps_size = filter.id == H5Z_FILTER_SHUFFLE && !is_deflated;
    const bool deflates = filter.id == H5Z_FILTER_DEFLATE && !is_deflated;
    if (!keeps_size && !deflates && filter.id != H5Z_FILTER_FLETCHER32) return h5::text_of(filter);
    is_deflated = is_deflated || deflates;
  }
  return std::nullopt;
}

}  // namespace landfall
