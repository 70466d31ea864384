// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "chain/terrain/features/feature.h"

namespace landfall {

/// The shapes that a pattern of lines may repeat.
using LineShape = std::variant<Ridge, Fracture>;

/// Copies of a ridge or fracture at uniform positions, as a Poisson process with a density per area: lengths
/// are uniform from shortest_m to the shape's own, yaws uniform within +-yaw_spread_rad of the shape's own.
/// Copies whose centre is off the site, but which may reach into it, are listed as well.
struct LinePattern {
  static constexpr bool kIsRandom = true;

  LineShape shape;
  double density_per_m2 = 0;
  double shortest_m = 0;
  double yaw_spread_rad = std::numbers::pi / 2;  ///< pi / 2: any direction
  /// Draws are functions of the site's seed and of this seed; empty: of the pattern's number instead.
  std::optional<std::uint64_t> seed = std::nullopt;

  static constexpr double kMaxLines = 1e6;

  /// Throws UsageError unless the shape is valid, also at its shortest, the density is finite and positive, 0
  /// < shortest_m <= the shape's length, the spread is in [0, pi / 2] and the seed is below 2^32.
  void validate(const std::string& owner) const;
  /// Throws UsageError if more than kMaxLines are expected.
  void require_bounded(const PatternSite& site) const;
  /// The lines by number; line i is a function of (seed, draw, i). Throws as require_bounded() does.
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const LinePattern&, const LinePattern&) = default;
};

}  // namespace landfall
