// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/numerics/random.h"
#include "base/raster/grid.h"
#include "chain/hazards/sigma_parts.h"

namespace landfall {

/// Adds independent normal noise to each bin, metres.
inline void add_noise(Grid<double>& z, double sigma, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::range_noise);
  for (std::size_t i = 0; i < z.spec().size(); ++i) z.values()[i] += sigma * field.normal(i);
}

/// The sigmas of a map whose bins have independent noise alone, metres.
inline SigmaParts noise_of(const GridSpec& spec, double noise) {
  return {Grid<float>(spec, static_cast<float>(noise)), Grid<float>(spec)};
}

}  // namespace landfall
