// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <iostream>

namespace landfall {

/// The seed of this run's random tests: LANDFALL_TEST_SEED, or a fixed one.
inline unsigned test_seed() {
  const char* const given = std::getenv("LANDFALL_TEST_SEED");
  const unsigned seed = given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : 7U;
  std::cout << "LANDFALL_TEST_SEED=" << seed << '\n';
  return seed;
}

}  // namespace landfall
