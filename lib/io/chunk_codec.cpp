// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/chunk_codec.h"

#include <libdeflate.h>

#include <memory>

#include "base/error.h"

namespace landfall {
namespace {

struct Compressor {
  int level = 0;
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> codec{nullptr,
                                                                                 libdeflate_free_compressor};
};

/// One compressor per thread: making one costs more than a small chunk.
libdeflate_compressor* compressor_for(int level) {
  thread_local Compressor compressor;
  if (compressor.level != level || !compressor.codec) {
    compressor.codec.reset(libdeflate_alloc_compressor(level));
    compressor.level = level;
    if (!compressor.codec) throw IoError("no memory for a compressor");
  }
  return compressor.codec.get();
}

std::vector<std::byte> shuffled(std::span<const std::byte> raw, std::size_t element_size) {
  const std::size_t count = raw.size() / element_size;
  std::vector<std::byte> result(raw.size());
  for (std::size_t byte = 0; byte < element_size; ++byte) {
    std::byte* const target = result.data() + byte * count;
    for (std::size_t i = 0; i < count; ++i) target[i] = raw[i * element_size + byte];
  }
  return result;
}

}  // namespace

std::vector<std::byte> encode_chunk(std::span<const std::byte> raw, std::size_t element_size, int level) {
  if (level == 0) return {raw.begin(), raw.end()};
  const std::vector<std::byte> bytes = shuffled(raw, element_size);
  libdeflate_compressor* const codec = compressor_for(level);
  std::vector<std::byte> result(libdeflate_zlib_compress_bound(codec, bytes.size()));
  const std::size_t size =
      libdeflate_zlib_compress(codec, bytes.data(), bytes.size(), result.data(), result.size());
  if (size == 0) throw IoError("compressing a chunk failed");
  result.resize(size);
  return result;
}

}  // namespace landfall
