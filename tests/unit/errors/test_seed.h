// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

namespace landfall {

/// The first seed of this run's random tests: LANDFALL_TEST_SEED, or a fixed one. It is printed.
inline std::uint64_t test_seed() {
  const char* const given = std::getenv("LANDFALL_TEST_SEED");
  const std::uint64_t seed = given == nullptr ? 20240607 : std::stoull(given);
  std::cout << "LANDFALL_TEST_SEED=" << seed << '\n';
  return seed;
}

}  // namespace landfall
