// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/numerics/random_seed.h"
#include "chain/terrain/features/added_shapes.h"
#include "chain/terrain/features/draped_shapes.h"
#include "chain/terrain/features/standing_shapes.h"

namespace landfall {

/// Each shape gives its name (kName, the word in configurations and object lists), its effect on the terrain
/// (kRole), its largest distance from the centre (reach_m: half the width of a box that holds its footprint),
/// its height at a point (relief_m: kNoRelief outside the footprint), its size for a list of objects, and a
/// check of its parameters (validate). A shape with a yaw_rad also gives own_relief_m, the relief at a point
/// in its own axes (shape.h), so that the rotation is computed once for all nodes. A new shape is a
/// struct in the header of its role and a name in this list.
using FeatureShape =
    std::variant<Cone, Hemisphere, Pyramid, Rock, Crater, IceBlock, Ridge, Fracture, Pit, PenitenteField>;

/// The kName of each shape, in the order of FeatureShape's alternatives.
[[nodiscard]] const std::vector<std::string>& feature_kinds();

/// A shape at a point, metres, frame D.
struct Feature {
  double x_m = 0;
  double y_m = 0;
  FeatureShape shape = Cone{};
  friend bool operator==(const Feature&, const Feature&) = default;
};

/// The site that a pattern (populations/patterns.h) fills, metres, frame D, and its random seed.
struct PatternSite {
  double west_m = 0;
  double east_m = 0;
  double south_m = 0;
  double north_m = 0;
  RandomSeed seed = {};
  std::uint64_t pattern = 0;  ///< number of the pattern: patterns with one seed are independent

  [[nodiscard]] double area_m2() const { return (east_m - west_m) * (north_m - south_m); }
};

/// `count` equal features on a circle about the origin, evenly spaced counter-clockwise from
/// first_azimuth_rad; azimuth 0 is +x.
struct RingPattern {
  static constexpr bool kIsRandom = false;

  std::int64_t count = 10;
  double radius_m = 25;
  double first_azimuth_rad = 0;
  FeatureShape shape = Cone{};

  /// Throws UsageError unless 1 <= count <= 1e6, radius_m is finite and >= 0 and the azimuth is finite.
  void validate(const std::string& owner) const;
  [[nodiscard]] std::vector<Feature> features(const PatternSite& site) const;
  friend bool operator==(const RingPattern&, const RingPattern&) = default;
};

/// Throws UsageError, beginning with `owner`, if a parameter is invalid.
void validate(const FeatureShape& shape, const std::string& owner);

}  // namespace landfall
