// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace landfall {

/// The size of the checksum that HDF5's filter fletcher32 appends to a chunk, little-endian.
inline constexpr std::size_t kFletcher32Bytes = 4;

/// The checksum of HDF5's filter fletcher32: Fletcher's, of the bytes as big-endian 16-bit words; an odd last
/// byte is the upper half of a word. Any single damaged word changes it, unless 0x0000 becomes 0xffff.
[[nodiscard]] std::uint32_t fletcher32(std::span<const std::byte> bytes);

}  // namespace landfall
