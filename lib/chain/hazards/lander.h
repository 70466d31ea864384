// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/raster/footprint.h"

namespace landfall {

/// The height of the ground under a pad, of the bins whose centres it covers.
enum class PadHeight { max, mean };

/// A lander that stands on pads at equal angles about its centre. Lengths in metres.
struct Lander {
  int legs = 4;                ///< 3 or 4
  double leg_radius_m = 0.85;  ///< from the centre to the centre of a pad, >= 2 bins
  double pad_diameter_m = 0.2;
  PadHeight pad_height = PadHeight::max;
  double body_radius_m = 0.85;  ///< of the disc under which the ground must stay below the plane of the pads
};

/// A length of a hazard configuration that a method needs to resolve in bins.
struct LengthInBins {
  const char* key;  ///< "lander/leg_radius_m"
  double length_m;
  int min_bins;
  const char* remark = "";  ///< why, in the message
};

/// Throws UsageError, naming the key and both remedies with their bounds, unless the length has so many bins.
void require_bins(const LengthInBins& length, double resolution_m);

/// A bin relative to the bin of the lander's centre.
struct BinOffset {
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  friend bool operator==(const BinOffset&, const BinOffset&) = default;
};

/// The bins of the legs' pads in one yaw; of three legs only the first three count.
using PadOffsets = std::array<BinOffset, 4>;

/// The bins that a lander touches on a map, relative to the bin of its centre.
struct LanderStencil {
  /// Throws UsageError, naming key and bound, for a number of legs, a length or a leg radius out of range.
  LanderStencil(const Lander& lander, double resolution_m);
  /// In this yaw of leg 0 alone, from +x to +y.
  LanderStencil(const Lander& lander, double resolution_m, double yaw_rad);

  int legs;
  double resolution_m;
  PadHeight pad_height;
  /// Yaws m (2 pi / legs) / M, m = 0 .. M - 1, M = ceil((2 pi / legs) R / s - 1e-9): from one to the next a
  /// pad moves by at most one bin. Leg k stands at yaw + 2 pi k / legs from +x, its pad in the bin nearest to
  /// (R cos, R sin) / s; of four legs the bins of legs 1 to 3 are those of leg 0, turned by quarter turns.
  std::vector<PadOffsets> yaws;
  Footprint pad;   ///< the bins whose centres are within pad_diameter_m / 2 + 1e-9 m of a pad's bin
  Footprint body;  ///< the bins whose centres are within body_radius_m + 1e-9 m of the centre
};

}  // namespace landfall
