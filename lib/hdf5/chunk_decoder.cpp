// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5/chunk_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "base/error.h"
#include "hdf5/byte_shuffle.h"
#include "hdf5/fletcher32.h"

namespace landfall {
namespace {

constexpr std::uint32_t kShuffleLeftOut = 1;
constexpr std::uint32_t kDeflateLeftOut = 2;
constexpr std::uint32_t kChecksumLeftOut = 1;

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

/// The bytes before the checksum; empty if they do not match it.
std::span<const std::byte> checked(std::span<const std::byte> stored) {
  if (stored.size() < kFletcher32Bytes) return {};
  const auto bytes = stored.first(stored.size() - kFletcher32Bytes);
  std::uint32_t checksum = 0;
  for (std::size_t i = 0; i < kFletcher32Bytes; ++i)
    checksum |= std::to_integer<std::uint32_t>(stored[bytes.size() + i]) << 8U * i;
  return fletcher32(bytes) == checksum ? bytes : std::span<const std::byte>();
}

/// The bytes of the chunk, shuffled if they are stored so; of another size if they are corrupt.
std::span<const std::byte> opened(std::span<const std::byte> stored, std::uint32_t filter_mask,
                                  const ChunkFormat& format) {
  if (format.filters == ChunkFilters::shuffle_deflate && (filter_mask & kDeflateLeftOut) == 0)
    return inflated(stored, format.byte_count());
  if (format.filters == ChunkFilters::fletcher32 && (filter_mask & kChecksumLeftOut) == 0)
    return checked(stored);
  return stored;
}

}  // namespace

bool decode_chunk(std::span<const std::byte> stored, std::uint32_t filter_mask, const ChunkFormat& format,
                  std::size_t first, std::span<std::byte> elements) {
  const bool shuffled =
      format.filters == ChunkFilters::shuffle_deflate && (filter_mask & kShuffleLeftOut) == 0;
  const std::span<const std::byte> bytes = opened(stored, filter_mask, format);
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
