// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace landfall {

/// How the bytes of a chunk are stored: the filters that our own files have, in their order; files of earlier
/// versions have fletcher32, or none.
enum class ChunkFilters { none, shuffle_deflate, deflate, fletcher32 };

/// How the chunks of a dataset are stored.
struct ChunkFormat {
  std::size_t element_size = 0;   ///< bytes
  std::size_t element_count = 0;  ///< in every chunk, including the last one
  ChunkFilters filters = ChunkFilters::none;

  [[nodiscard]] std::size_t byte_count() const { return element_size * element_count; }
};

/// Undoes the filters of one chunk as HDF5 stored it and returns as many elements as `elements` holds, from
/// number `first` on; they must lie in the chunk. Bit i of filter_mask says that filter i was not applied to
/// this chunk. Returns false, with `elements` unspecified, if the bytes are not a zlib stream, do not have
/// the chunk's size or do not match their checksum. Throws IoError if memory is short.
[[nodiscard]] bool decode_chunk(std::span<const std::byte> stored, std::uint32_t filter_mask,
                                const ChunkFormat& format, std::size_t first, std::span<std::byte> elements);

}  // namespace landfall
