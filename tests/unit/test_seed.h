// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

namespace landfall {

/// The seed of this run's random tests: LANDFALL_TEST_SEED, or a fixed one. It is printed once.
inline std::uint64_t test_seed() {
  static const std::uint64_t seed = [] {
    const char* const given = std::getenv("LANDFALL_TEST_SEED");
    const std::uint64_t value = given == nullptr ? 20261121U : std::stoull(given);
    std::cout << "LANDFALL_TEST_SEED=" << value << '\n';
    return value;
  }();
  return seed;
}

}  // namespace landfall
