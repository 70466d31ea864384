// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Random123/philox.h>

#include <cstdint>
#include <span>

namespace landfall {

/// Blocks of Philox4x64-10 (Salmon et al. 2011) with the counters (i, first_j + k, draw, 0), k = 0, 1, ...
struct PhiloxRow {
  r123::Philox4x64::key_type key;
  std::uint64_t i;
  std::uint64_t first_j;
  std::uint64_t draw;
};

/// The block with the counter (i, j, draw, 0).
[[nodiscard]] inline r123::Philox4x64::ctr_type philox_block(r123::Philox4x64::key_type key, std::uint64_t i,
                                                             std::uint64_t j, std::uint64_t draw) {
  return r123::Philox4x64()({{i, j, draw, 0}}, key);
}

/// The upper 53 bits of a word as a multiple of 2^-53 in [0, 1).
[[nodiscard]] inline double uniform_of(std::uint64_t word) {
  return static_cast<double>(static_cast<std::int64_t>(word >> 11U)) * 0x1p-53;
}

/// first[k] and second[k]: uniform_of() the first two words of block k. `second` may be empty. In SIMD lanes
/// on processors with AVX-512, by Random123 on others: vectors without 64-bit products take longer than it.
void philox_uniforms(const PhiloxRow& row, std::span<double> first, std::span<double> second);

}  // namespace landfall
