// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace landfall {

/// The order of HDF5's shuffle filter: byte 0 of every element, then byte 1, and so on: one plane per byte of
/// an element. `elements` and `planes` have one size, a multiple of element_size (>= 1).
void shuffle_bytes(std::span<const std::byte> elements, std::size_t element_size,
                   std::span<std::byte> planes);

/// The inverse for some elements: `elements` receives as many as it holds, from number `first` on. They must
/// lie among those of `planes`.
void unshuffle_bytes(std::span<const std::byte> planes, std::size_t element_size, std::size_t first,
                     std::span<std::byte> elements);

/// The size of the checksum that HDF5's filter fletcher32 appends to a chunk, little-endian.
inline constexpr std::size_t kFletcher32Bytes = 4;

/// The checksum of HDF5's filter fletcher32: Fletcher's, of the bytes as big-endian 16-bit words; an odd last
/// byte is the upper half of a word. Any single damaged word changes it, unless 0x0000 becomes 0xffff.
[[nodiscard]] std::uint32_t fletcher32(std::span<const std::byte> bytes);

}  // namespace landfall
