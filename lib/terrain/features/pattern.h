// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <variant>

#include "raster/grid_spec.h"
#include "terrain/features/feature.h"
#include "terrain/populations/line_pattern.h"
#include "terrain/populations/patterns.h"

namespace landfall {

/// A pattern generates many features: features() lists them in a fixed order, a pure function of pattern and
/// site. kByChance is true if their positions are random. A new pattern is a file and a name in this list.
using FeaturePattern = std::variant<RingPattern, RockPattern, IceBlockPattern, CraterPattern, LinePattern>;

/// The site that a pattern fills on a grid.
[[nodiscard]] inline PatternSite pattern_site(const GridSpec& grid, std::uint64_t seed, std::size_t number) {
  return {grid.x(0), grid.x(grid.cols - 1), grid.y(0), grid.y(grid.rows - 1), seed, number};
}

/// Throws the UsageError that features() would throw immediately, without drawing anything.
inline void require_bounded(const FeaturePattern& pattern, const PatternSite& site) {
  std::visit(
      [&](const auto& p) {
        if constexpr (requires { p.require_bounded(site); }) p.require_bounded(site);
      },
      pattern);
}

}  // namespace landfall
