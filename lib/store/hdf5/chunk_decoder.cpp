// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "base/core/error.h"
#include "store/hdf5/chunk_filters.h"

namespace landfall {
namespace {

constexpr std::uint32_t kFirstLeftOut = 1;
constexpr std::uint32_t kSecondLeftOut = 2;

/// One decompressor per thread, and memory for a chunk.
struct Inflater {
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> codec{
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor};
  std::vector<std::byte> bytes;
};

Inflater& inflater() {
  thread_local Inflater mine;
  if (!mine.codec) throw IoError("no memory for a decompressor");
  return mine;
}

/// False unless the stream holds exactly as many bytes as `out` has room for.
bool inflate_into(std::span<const std::byte> stored, std::span<std::byte> out) {
  return libdeflate_zlib_decompress(inflater().codec.get(), stored.data(), stored.size(), out.data(),
                                    out.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

/// The decompressed chunk, valid until the next call on this thread; empty if it is corrupt.
std::span<const std::byte> inflated(std::span<const std::byte> stored, std::size_t size) {
  std::vector<std::byte>& bytes = inflater().bytes;
  bytes.resize(std::max(size, bytes.size()));
  const std::span<std::byte> out = std::span(bytes).first(size);
  return inflate_into(stored, out) ? out : std::span<std::byte>();
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
  if (format.filters == ChunkFilters::shuffle_deflate && (filter_mask & kSecondLeftOut) == 0)
    return inflated(stored, format.byte_count());
  if (format.filters == ChunkFilters::deflate && (filter_mask & kFirstLeftOut) == 0)
    return inflated(stored, format.byte_count());
  if (format.filters == ChunkFilters::fletcher32 && (filter_mask & kFirstLeftOut) == 0)
    return checked(stored);
  return stored;
}

}  // namespace

bool decode_chunk(std::span<const std::byte> stored, std::uint32_t filter_mask, const ChunkFormat& format,
                  std::size_t first, std::span<std::byte> elements) {
  const bool shuffled = format.filters == ChunkFilters::shuffle_deflate && (filter_mask & kFirstLeftOut) == 0;
  if (format.filters == ChunkFilters::deflate && filter_mask == 0 && elements.size() == format.byte_count())
    return inflate_into(stored, elements);
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
