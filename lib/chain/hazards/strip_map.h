// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "chain/hazards/hazard_map.h"

namespace landfall {

/// A map whose elevations are never in memory as a whole.
struct StripSource {
  GridSpec spec;
  std::int64_t strip_rows;  ///< rows that are judged at a time, >= 1
  /// Loads the elevations of whole rows of the map, which may have holes.
  std::function<Grid<double>(const GridSpec& rows)> load;
  std::optional<BinMask> region = std::nullopt;  ///< the places, if the region's shape is mask or polygon
};

/// Takes the measures of a strip: whole rows of the map, from its first to its last.
using TakeMeasures = std::function<void(const PlaceMeasures& strip)>;

/// Judges a map strip by strip, without a truth and without a probability. Region, safe and sites are those
/// of map_hazards() for a map without truth and sigmas, and so are the measures that `take` gets; the other
/// layers of the result stay empty.
///
/// Throws as map_hazards() and require_memory().
[[nodiscard]] HazardMap map_strips(const StripSource& source, const HazardParameters& parameters,
                                   const TakeMeasures& take, const PhaseRunner& phase);

}  // namespace landfall
