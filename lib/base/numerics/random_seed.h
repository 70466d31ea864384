// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace landfall {

/// Chooses random numbers: no two different pairs have one in common (RandomField, base/numerics/random.h).
struct RandomSeed {
  // NOLINTNEXTLINE(google-explicit-constructor): a seed alone is its draw 0
  constexpr RandomSeed(std::uint64_t of_seed = 1, std::uint32_t of_draw = 0) : seed(of_seed), draw(of_draw) {}

  std::uint64_t seed;
  std::uint32_t draw;  ///< below 2^31
  friend bool operator==(const RandomSeed&, const RandomSeed&) = default;
};

}  // namespace landfall
