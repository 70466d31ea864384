// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "store/hdf5/chunk_codec.h"

namespace landfall {

/// Encodes one chunk with a new encoder.
inline std::vector<std::byte> encode_chunk(std::span<const std::byte> raw, std::size_t element_size,
                                           int level) {
  ChunkEncoder encoder(element_size, level);
  const auto encoded = encoder.encode(raw);
  return {encoded.begin(), encoded.end()};
}

}  // namespace landfall
