// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "chain/hazards/measures.h"
#include "chain/hazards/return_centroids.h"
#include "chain/hazards/safety.h"
#include "chain/hazards/sigma_parts.h"

namespace landfall {

/// Slope and roughness of some places of a map.
using MeasurePlaces = std::function<PlaceMeasures(const Grid<double>& z, const BinMask& places)>;

/// The number of terrains that p_safe is computed from.
inline constexpr std::uint64_t kSafeTerrains = 8;

/// A map, and what safe_probability() needs to know of it.
struct MapEvidence {
  const Grid<double>& z;  ///< counts where the parts of sigma are not NaN
  SigmaParts sigma;
  const PlaceMeasures& measured;  ///< of the map as it is; NaN where it is unknown
  const BinMask& region;
  std::uint64_t seed = 1;
  std::optional<ReturnCentroids> centroids = std::nullopt;  ///< without, z is that of the bins' centres
};

/// P of each place, as far as the evidence carries it.
struct SafeProbability {
  Grid<float> p;   ///< NaN where the lander reaches beyond the map, or bins far from any measured one
  BinMask capped;  ///< 1 where p is as large as the evidence of the place allows: P is at least p
  float cap = 0;   ///< the largest p that a place of the region could have
};

/// The probability that the true terrain of each place of the region is within the limits, given the map and
/// its 1 sigma: of all terrains that may lie under the map (terrain_posterior.h), the share on which the
/// place is safe. Eight of them are measured. With the mean m of the distance to a limit and its standard
/// deviation s, pooled over the places within a pad and a bin,
///   P = T(m / (s sqrt(1 + 1/8))) for slope, times the same for roughness,
/// T being Student's distribution of 5 degrees of freedom, that of a distance whose spread is known to a
/// third (1 / sqrt(2 x 5)). Places where three terrains leave no doubt are not measured on the others, and
/// none at all where `measured` is more than 8 times the largest sigma about the lander (over slope_base_m
/// for the slope) below both limits or above one of them, if each bin about the lander was measured.
///
/// P is nowhere nearer to 0 or 1 than T(-8) = 0.00025. Nor is 1 - P less than 1 / (8 n), n being the bins
/// under the body that have a sigma: what none of the eight terrains showed in any of these bins, a rarer
/// hazard, has no smaller probability.
[[nodiscard]] SafeProbability safe_probability(MapEvidence map, const LanderStencil& lander,
                                               const HazardLimits& limits, double slope_base_m,
                                               const MeasurePlaces& measure);

/// The bins within which the probability of a place depends on the map.
[[nodiscard]] std::int64_t safe_probability_reach(const LanderStencil& lander);

}  // namespace landfall
