// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "chain/terrain/populations/population.h"

namespace landfall {

/// A site of one hectare about the origin.
inline PatternSite hectare(std::uint64_t seed = 1, std::uint64_t pattern = 0) {
  return {-50, 50, -50, 50, seed, pattern};
}

inline constexpr PopulationKind kTestRocks{"rock", RandomStream::rock_population, 0.5, false};
inline constexpr PopulationKind kTestCraters{"crater", RandomStream::crater_population, 0.75, true};

inline std::vector<ScatteredObject> drawn(const Population& population, const PatternSite& site,
                                          const PopulationKind& kind = kTestRocks) {
  return PopulationSampler(population, kind, site).objects();
}

}  // namespace landfall
