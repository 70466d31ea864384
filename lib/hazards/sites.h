// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hazards/reachable_area.h"
#include "hazards/safety.h"

namespace landfall {

struct SiteParameters {
  std::int64_t count = 5;
  double separation_m = 5;                            ///< least distance between two sites
  double divert_radius_m = 40;                        ///< scale of the cost, > 0
  double divert_weight = 0.1;                         ///< cost of a site at divert_radius_m
  double min_p = 0.99;                                ///< p_touchdown that a required site has
  std::optional<ReachableArea> reach = std::nullopt;  ///< none: the circle of divert_radius_m
};

/// The probability that a touchdown at sigma_m (1 sigma along each axis) about a place is safe: p smoothed by
/// exp(-(k s)^2 / 2 sigma^2), |k| s <= 3 sigma + 1e-9, along x, then along y, normalised over the whole
/// kernel. NaN and bins off the map count 0. sigma_m >= 0; 0 copies. NaN outside the region.
[[nodiscard]] Grid<float> touchdown_probability(const Grid<float>& p, double sigma_m, const BinMask& region);

/// The places among which sites are looked for.
[[nodiscard]] ReachableArea reachable_area(const SiteParameters& parameters);

/// 1 - p_touchdown + divert_weight d / divert_radius_m, d the distance to the origin; NaN outside the
/// reachable area and where p_touchdown is.
[[nodiscard]] Grid<float> landing_cost(const Grid<float>& p_touchdown, const SiteParameters& parameters);

/// The distance in metres to the nearest bin of the region that is not safe; NaN without such a bin, and
/// outside the region.
[[nodiscard]] Grid<float> distance_to_hazard(const Grid<std::int8_t>& safe, const BinMask& region);

/// The safe places of least cost: each is the best of the others at least separation_m - 1e-9 from all
/// before. Of equal costs the one nearer to the origin is better, then the lower row, then the lower column.
[[nodiscard]] std::vector<BinIndex> choose_sites(const Grid<float>& cost, const Grid<std::int8_t>& safe,
                                                 const SiteParameters& parameters);

}  // namespace landfall
