// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "terrain/features/feature.h"
#include "terrain/populations/population.h"

namespace landfall {

// Patterns that scatter objects randomly. validate() throws UsageError where a parameter makes no sense;
// features() lists the objects in descending order of diameter, a pure function of pattern and site, and
// throws UsageError as PopulationSampler does; require_bounded() throws it where that is known before a draw.

/// Half-buried ellipsoids, their centres on the site: horizontal axes 1 : 0.8, any yaw, heights of 0.5 +- 0.1
/// (1 sigma) of the diameter, cut to 0.25 .. 0.75.
struct RockPattern {
  static constexpr bool kByChance = true;

  Population population;

  void validate(const std::string& owner) const { population.validate(owner); }
  void require_bounded(const PatternSite& site) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const RockPattern&, const RockPattern&) = default;
};

/// Boxes of ice, their centres on the site: the diameter is the length, the width 0.8 of it, heights as
/// those of rocks, any yaw, tilts uniform within +-max_tilt_rad.
struct IceBlockPattern {
  static constexpr bool kByChance = true;

  /// Up to which the length stays the longest side of every block's footprint.
  static constexpr double kMaxTilt_rad = 15 * std::numbers::pi / 180;

  Population population;
  double max_tilt_rad = 10 * std::numbers::pi / 180;

  /// The tilt must lie in [0, kMaxTilt_rad].
  void validate(const std::string& owner) const;
  void require_bounded(const PatternSite& site) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const IceBlockPattern&, const IceBlockPattern&) = default;
};

/// Craters of the fresh depth of their size, degraded by a freshness that is uniform in [freshness_min, 1].
/// Those whose centre is off the site, but whose rim or ejecta reach into it, are listed as well, so that
/// the site's edge has as many as its middle.
struct CraterPattern {
  static constexpr bool kByChance = true;

  Population population;
  double freshness_min = 0.1;

  /// The freshness must lie in (0, 1].
  void validate(const std::string& owner) const;
  void require_bounded(const PatternSite& site) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const CraterPattern&, const CraterPattern&) = default;
};

}  // namespace landfall
