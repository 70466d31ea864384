// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D451
#include "chain/evaluation/assumptions.h"

#include <algorithm>
#include <vector>

#include "chain/evaluation/median.h"

namespace landfall {

AssumptionMetrics assumptions_of(const DemLayers& dem, const BinMask& region, const Footprint& footprint) {
  AssumptionMetrics result{.footprint_bins = footprint.edge_bins()};
  if (dem.truth) result.truth_spacing_m = dem.truth_spacing_m;
  if (!dem.count) return result;
  std::vector<std::int32_t> counts;
  for (std::size_t i = 0; i < region.spec().size(); ++i)
    if (const std::int32_t count = dem.count->values()[i]; region.values()[i] != 0 && count > 0)
      counts.push_back(count);
  if (counts.empty()) return result;
  result.single_return_frac =
      static_cast<double>(std::ranges::count(counts, 1)) / static_cast<double>(counts.size());
  result.median_returns_per_bin = median_of(counts);
  return result;
}

}  // namespace landfall
