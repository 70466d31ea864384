// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/core/progress.h"
#include "chain/hazards/hazard_map.h"
#include "chain/hazards/lander.h"
#include "chain/hazards/measures.h"

namespace landfall {

/// Measures the places of a map, or of a part of it, by the method of the configuration.
class MapJudge {
 public:
  /// Throws UsageError "lander/KEY: ..." or "limits/roughness_m: ..." for what a map of this size cannot hold
  /// or resolve. Refers to the parameters.
  MapJudge(const HazardParameters& parameters, const GridSpec& map);

  [[nodiscard]] const LanderStencil& lander() const { return lander_; }
  /// The largest offset of a row or column from a place to a bin on which its measures depend.
  [[nodiscard]] std::int64_t reach_bins() const { return reach_bins_; }
  /// The measures of `places`, bins of z. Those of one place depend on the bins in its reach alone.
  [[nodiscard]] PlaceMeasures measure(const Grid<double>& z, const BinMask& places,
                                      const ProgressCallback& progress = {}) const;
  /// The length over which the noise of a bin becomes a gradient: the legs' radius, the width of the window,
  /// the root of the sum of dx^2 over the body, or the body's radius, over which a triple of samples extends.
  [[nodiscard]] double slope_base_m() const;

 private:
  const HazardParameters& parameters_;
  std::int64_t reach_bins_;
  LanderStencil lander_;
  RangeWindows windows_{};
};

/// The lander whose stencil the method uses: methods other than contact have no legs. Throws UsageError for a
/// body of too few bins.
[[nodiscard]] Lander lander_for(const HazardParameters& parameters, double resolution_m);

/// The places of the region: `mask` for a shape that is one, else the circle, of which parts may lie beyond
/// the map.
[[nodiscard]] BinMask region_of(const GridSpec& map, const std::optional<BinMask>& mask,
                                const HazardParameters& parameters);

/// The places of the region that have an elevation.
[[nodiscard]] std::int64_t known_places(const Grid<double>& z, const BinMask& region);

/// Why every place of the region is unknown, `known` of which have an elevation: "nothing to judge: ...".
[[nodiscard]] std::string unknown_reason(const BinMask& region, std::int64_t known,
                                         const HazardParameters& parameters);

}  // namespace landfall
