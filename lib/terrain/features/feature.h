// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "terrain/features/cone.h"
#include "terrain/features/hemisphere.h"
#include "terrain/features/pyramid.h"

namespace landfall {

/// Each shape says how far it reaches from its centre (reach_m: half the width of a box that holds its
/// footprint), what the elevation becomes at a place (elevation_m: ground.here_m outside the footprint), and
/// whether its parameters make sense (validate). A new shape is a file here and a name in this list.
using FeatureShape = std::variant<Cone, Hemisphere, Pyramid>;

/// A shape at a place, metres, frame D. It stands on the summed base under its centre.
struct Feature {
  double x_m = 0;
  double y_m = 0;
  FeatureShape shape = Cone{};
  friend bool operator==(const Feature&, const Feature&) = default;
};

/// `count` equal features on a circle about the origin, evenly spaced counter-clockwise from
/// first_azimuth_rad; azimuth 0 is +x.
struct RingPattern {
  std::int64_t count = 10;
  double radius_m = 25;
  double first_azimuth_rad = 0;
  FeatureShape shape = Cone{};

  /// Throws UsageError unless 1 <= count <= 1e6, radius_m is finite and >= 0 and the azimuth is finite.
  void validate(const std::string& owner) const;
  [[nodiscard]] std::vector<Feature> features() const;
  friend bool operator==(const RingPattern&, const RingPattern&) = default;
};

/// A pattern stands for many features: features() lists them in a fixed order.
using FeaturePattern = std::variant<RingPattern>;

/// Throws UsageError, its message begun by `owner`, where a parameter makes no sense.
void validate(const FeatureShape& shape, const std::string& owner);

}  // namespace landfall
