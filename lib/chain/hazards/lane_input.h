// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/raster/region.h"
#include "chain/hazards/lander.h"
#include "chain/hazards/padded_map.h"

namespace landfall {

/// The input of the lanes of measure_contact().
struct ContactInput {
  const PaddedMap& z;
  const PaddedMap& pad_heights;
  const LanderStencil& lander;
  const BinMask& places;  ///< each known
};

/// The input of the lanes of a method that fits one plane to the bins under the body.
struct BodyInput {
  const PaddedMap& z;
  const Footprint& body;
  double resolution_m;
  const BinMask& places;  ///< each known
};

/// The input of the lanes of measure_plane(). Over the disc sum dc = sum dr = sum dc dr = 0 and sum dc^2 =
/// sum dr^2.
struct PlaneInput {
  BodyInput terrain;
  double count;   ///< bins under the body
  double square;  ///< sum dc^2
};

/// Three samples, by number, and the gradient of the plane through them per rise of the second and of the
/// third above the first.
struct SampleTriple {
  std::array<std::size_t, 3> samples;
  std::array<double, 2> east, north;
};

/// The input of the lanes of measure_lmeds().
struct LmedsInput {
  BodyInput terrain;
  const std::vector<BinOffset>& samples;  ///< an odd number
  const std::vector<SampleTriple>& triples;
};

}  // namespace landfall
