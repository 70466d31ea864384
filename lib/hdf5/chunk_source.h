// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hdf5/chunk_decoder.h"
#include "hdf5/h5.h"

namespace landfall {

/// A chunk's bytes as they lie in the file.
struct StoredChunk {
  std::vector<std::byte> bytes;
  std::uint32_t filter_mask = 0;
};

/// Chunks that can be decoded without HDF5.
struct DecodableChunks {
  h5::Type type;
  ChunkFormat format;
};

/// Chunks of exactly `chunk` elements (one number per dimension), without filters or with shuffle and
/// deflate, of one of the little-endian types of h5::Type. Anything else, which other programs may write, is
/// left to h5::read_values(): nothing is returned.
[[nodiscard]] std::optional<DecodableChunks> decodable_chunks(hid_t dataset, std::span<const hsize_t> chunk);

/// The file of a dataset's chunks. Many threads may load chunks at once: HDF5 tells, under
/// h5::library_lock(), where they lie, and their bytes are read beside it.
class ChunkFile {
 public:
  /// The file must stay open.
  explicit ChunkFile(hid_t dataset) : descriptor_(h5::descriptor(dataset)) {}

  /// As load_chunk().
  [[nodiscard]] bool load(hid_t dataset, std::span<const hsize_t> offset, StoredChunk& chunk) const;

 private:
  std::optional<int> descriptor_;
};

/// Reads the chunk whose first element has the index `offset`, one number per dimension. False where the file
/// holds no such chunk (its elements are the fill value) or HDF5 fails. HDF5 is not reentrant: one call at a
/// time.
[[nodiscard]] bool load_chunk(hid_t dataset, std::span<const hsize_t> offset, StoredChunk& chunk);

}  // namespace landfall
