// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "base/numerics/random_seed.h"
#include "base/raster/grid_spec.h"
#include "chain/terrain/features/feature.h"
#include "chain/terrain/populations/line_pattern.h"
#include "chain/terrain/populations/population.h"

namespace landfall {

// Patterns that scatter objects randomly. validate() throws UsageError if a parameter is invalid; features()
// lists the objects in descending order of diameter, a pure function of pattern and site, and throws
// UsageError as PopulationSampler does; require_bounded() throws it if that is known before a draw.

/// Half-buried ellipsoids with centres on the site: horizontal axes 1 : 0.8 and the area of a disc of the
/// diameter, any yaw, heights of 0.5 +- 0.1 (1 sigma) of the diameter, clamped to 0.25 .. 0.75.
struct RockPattern {
  static constexpr bool kIsRandom = true;

  Population population;

  void validate(const std::string& owner) const { population.validate(owner); }
  void require_bounded(const PatternSite& site) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const RockPattern&, const RockPattern&) = default;
};

/// Boxes of ice with centres on the site: the diameter is the length, the width 0.8 of it, heights as for
/// rocks, any yaw, tilts uniform within +-max_tilt_rad.
struct IceBlockPattern {
  static constexpr bool kIsRandom = true;

  /// Up to this tilt the length is the longest side of every block's footprint.
  static constexpr double kMaxTilt_rad = 15 * std::numbers::pi / 180;

  Population population;
  double max_tilt_rad = 10 * std::numbers::pi / 180;

  /// The tilt must lie in [0, kMaxTilt_rad].
  void validate(const std::string& owner) const;
  void require_bounded(const PatternSite& site) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const IceBlockPattern&, const IceBlockPattern&) = default;
};

/// Craters with the fresh depth of their size, degraded by a freshness that is uniform in [freshness_min, 1].
/// Craters whose centre is off the site, but whose rim or ejecta reach into it, are listed as well, so that
/// the density at the site's edge equals that at its middle.
struct CraterPattern {
  static constexpr bool kIsRandom = true;

  Population population;
  double freshness_min = 0.1;

  /// The freshness must lie in (0, 1].
  void validate(const std::string& owner) const;
  void require_bounded(const PatternSite& site) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const CraterPattern&, const CraterPattern&) = default;
};

/// A pattern generates many features: features() lists them in a fixed order, a pure function of pattern and
/// site. kIsRandom is true if their positions are random. A new pattern is a struct and a name in this list.
using FeaturePattern = std::variant<RingPattern, RockPattern, IceBlockPattern, CraterPattern, LinePattern>;

/// The site that a pattern fills on a grid.
[[nodiscard]] inline PatternSite pattern_site(const GridSpec& grid, RandomSeed seed, std::size_t number) {
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
