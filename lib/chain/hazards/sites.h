// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chain/hazards/reachable_area.h"
#include "chain/hazards/safety.h"

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

/// The largest offset along an axis at which a place counts: 3 sigma_m + 1e-9.
[[nodiscard]] double touchdown_reach_m(double sigma_m);

/// The places among which sites are looked for.
[[nodiscard]] ReachableArea reachable_area(const SiteParameters& parameters);

/// 1 - p_touchdown + divert_weight d / divert_radius_m, d the distance to the origin; NaN outside the
/// reachable area and where p_touchdown is.
[[nodiscard]] Grid<float> landing_cost(const Grid<float>& p_touchdown, const SiteParameters& parameters);

/// The distance in metres to the nearest bin of the region that is not safe; NaN without such a bin, and
/// outside the region.
[[nodiscard]] Grid<float> hazard_distance(const Grid<std::int8_t>& safe, const BinMask& region);

struct SitePlace {
  BinIndex bin;
  float cost = 0;
};
/// Whether a site at `a` is better than one at `b`: of less cost, else nearer to the origin, else in the
/// lower row, else in the lower column.
[[nodiscard]] bool is_better(const GridSpec& spec, const SitePlace& a, const SitePlace& b);

/// Whether two bins, which need not lie in the grid, are at least separation_m - 1e-9 apart and not the same.
[[nodiscard]] bool is_apart(const GridSpec& spec, BinIndex a, BinIndex b, const SiteParameters& parameters);

/// The best of the safe places with a cost that are apart from all of `sites`, which need not lie in the
/// grid.
[[nodiscard]] std::optional<SitePlace> best_place(const Grid<float>& cost, const Grid<std::int8_t>& safe,
                                                  std::span<const BinIndex> sites,
                                                  const SiteParameters& parameters);

/// The best places, each the best of those apart from all before.
[[nodiscard]] std::vector<BinIndex> choose_sites(const Grid<float>& cost, const Grid<std::int8_t>& safe,
                                                 const SiteParameters& parameters);

}  // namespace landfall
