// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "chain/hazards/sites.h"

namespace landfall {

/// A place that was chosen as a site.
struct FoundSite {
  BinIndex bin;
  float cost = 0, p_touchdown = 0;
};

/// The places of a map without p_safe, among which sites are looked for.
struct JudgedPlaces {
  const Grid<std::int8_t>& safe;
  const BinMask& region;
  double touchdown_sigma_m;
};

/// The sites that choose_sites() finds on the cost of the whole map, best first. Smooths and weighs one tile
/// of `tile_bins` x `tile_bins` bins at a time, so that cost and p_touchdown of the map are never in memory.
/// The best places of tiles are kept, and looked for again only where a site before is too near.
[[nodiscard]] std::vector<FoundSite> find_sites(const JudgedPlaces& places, const SiteParameters& parameters,
                                                std::int64_t tile_bins);

/// The value of hazard_distance() at one bin of the region; nothing where it is NaN.
[[nodiscard]] std::optional<float> hazard_distance_at(const JudgedPlaces& places, BinIndex bin);

}  // namespace landfall
