// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5/chunk_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "base/error.h"
#include "hdf5/byte_shuffle.h"

namespace landfall {
namespace {

constexpr std::uint32_t kShuffleLeftOut = 1;
constexpr std::uint32_t kDeflateLeftOut = 2;

/// One decompressor per thread, and memory for a chunk.
struct Inflater {
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> codec{
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor};
  std::vector<std::byte> bytes;
};

/// The decompressed chunk, valid until the next call on this thread; empty if it is corrupt.
std::span<const std::byte> inflated(std::span<const std::byte> stored, std::size_t size) {
  thread_local Inflater inflater;
  if (!inflater.codec) throw IoError("no memory for a decompressor");
  inflater.bytes.resize(std::max(size, inflater.bytes.size()));
  const libdeflate_result result = libdeflate_zlib_decompress(
      inflater.codec.get(), stored.data(), stored.size(), inflater.bytes.data(), size, nullptr);
  if (result != LIBDEFLATE_SUCCESS) return {};
  return std::span(inflater.bytes).first(size);
}

}  // namespace

bool decode_chunk(std::span<const std::byte> stored, std::uint32_t filter_mask, const ChunkFormat& format,
                  std::size_t first, std::span<std::byte> elements) {
  const bool deflated = format.filtered && (filter_mask & kDeflateLeftOut) == 0;
  const bool shuffled = format.filtered && (filter_mask & kShuffleLeftOut) == 0;
  const std::span<const std::byte> bytes = deflated ? inflated(stored, format.byte_count()) : stored;
  if (bytes.size() != format.byte_count()) return false;
  if (shuffled) {
    unshuffle_bytes(bytes, format.element_size, first, elements);
  } else {
    std::memcpy(elements.data(), bytes.subspan(first * format.element_size, elements.size()).data(),
                elements.size());
  }
  return true;
}

}  // namespace landfall
