// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace landfall {

/// How the chunks of a dataset are stored.
struct ChunkFormat {
  std::size_t element_size = 0;   ///< bytes
  std::size_t element_count = 0;  ///< of every chunk, also of the last one
  bool filtered = false;          ///< through shuffle, then deflate; otherwise plain

  [[nodiscard]] std::size_t byte_count() const { return element_size * element_count; }
};

/// Undoes the filters of one chunk as HDF5 stored it and gives its elements from number `first` on, as many
/// as `elements` holds; they must lie in the chunk. Bit i of filter_mask says that filter i was left out for
/// this chunk. Returns false, with `elements` unspecified, where the bytes are not a zlib stream or not of
/// the chunk's size. Throws IoError where there is no memory.
[[nodiscard]] bool decode_chunk(std::span<const std::byte> stored, std::uint32_t filter_mask,
                                const ChunkFormat& format, std::size_t first, std::span<std::byte> elements);

}  // namespace landfall
