// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace landfall {

/// The largest number of bytes that one byte of a deflate stream can represent.
inline constexpr unsigned kMaxDeflate = 1032;

/// The bytes of one chunk as HDF5's own shuffle and deflate filters would store it, so that any HDF5 reader
/// opens it: byte 0 of every element, then byte 1, ..., compressed by libdeflate in zlib form. At level 0
/// the bytes stay as they are, unshuffled, in the stored blocks of a zlib stream, for HDF5's filter deflate
/// alone; only zeros at the end, the rows that a short table does not have, are compressed. Either form has
/// the checksum of a zlib stream, which shows a damaged chunk.
///
/// Below level 6, neighbouring bytes of numbers are stored uncompressed where a trial finds noise in them:
/// searching noise for repetitions takes four fifths of the time and saves nothing. The trial uses samples,
/// so a chunk may lose some of its compression, at most what those bytes could have saved.
///
/// An encoder keeps its memory, about the size of a chunk, from one chunk to the next, and so does the
/// thread. Use an encoder in one thread at a time.
class ChunkEncoder {
 public:
  /// `level` in 0..9, or h5::kPlain: the bytes as they are.
  ChunkEncoder(std::size_t element_size, int level) : element_size_(element_size), level_(level) {}

  /// Valid until the next call. Throws IoError if libdeflate refuses (out of memory).
  [[nodiscard]] std::span<const std::byte> encode(std::span<const std::byte> raw);

 private:
  std::size_t element_size_;
  int level_;
  std::vector<std::byte> stream_;
};

}  // namespace landfall
