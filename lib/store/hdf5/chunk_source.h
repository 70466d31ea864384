// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "store/hdf5/chunk_decoder.h"
#include "store/hdf5/h5.h"

namespace landfall {

/// The bytes of a chunk as stored in the file.
struct StoredChunk {
  std::vector<std::byte> bytes;
  std::uint32_t filter_mask = 0;
};

/// Chunks that can be decoded without HDF5.
struct DecodableChunks {
  h5::Type type;
  ChunkFormat format;
};

/// Chunks of exactly `chunk` elements (one number per dimension), without filters, with shuffle and
/// deflate, with deflate or with fletcher32, of one of the little-endian types of h5::Type. For any other
/// form, which other programs may write, returns nothing: use h5::read_values().
[[nodiscard]] std::optional<DecodableChunks> decodable_chunks(hid_t dataset, std::span<const hsize_t> chunk);

/// The file that holds a dataset's chunks. Several threads may load chunks at the same time: HDF5 gives their
/// addresses under h5::library_lock(), and the bytes are read without HDF5.
class ChunkFile {
 public:
  /// The file must stay open.
  explicit ChunkFile(hid_t dataset) : descriptor_(h5::descriptor(dataset)) {}

  /// As load_chunk().
  [[nodiscard]] bool load(hid_t dataset, std::span<const hsize_t> offset, StoredChunk& chunk) const;

 private:
  std::optional<int> descriptor_;
};

/// Reads the chunk whose first element has the index `offset`, one number per dimension. Returns false if the
/// file holds no such chunk (its elements are the fill value) or HDF5 fails. HDF5 is not reentrant: one call
/// at a time.
[[nodiscard]] bool load_chunk(hid_t dataset, std::span<const hsize_t> offset, StoredChunk& chunk);

}  // namespace landfall
