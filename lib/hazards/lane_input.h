// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hazards/lander.h"
#include "hazards/padded_map.h"
#include "raster/region.h"

namespace landfall {

/// What the lanes of measure_contact() need.
struct ContactInput {
  const PaddedMap& z;
  const PaddedMap& pad_heights;
  const LanderStencil& lander;
  const BinMask& places;  ///< each known
};

/// What the lanes of measure_plane() need. Over the disc sum dc = sum dr = sum dc dr = 0 and sum dc^2 = sum
/// dr^2.
struct PlaneInput {
  const PaddedMap& z;
  const Footprint& body;
  double resolution_m;
  double count;   ///< bins under the body
  double square;  ///< sum dc^2
  const BinMask& places;
};

}  // namespace landfall
