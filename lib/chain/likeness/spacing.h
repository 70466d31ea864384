// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "base/raster/grid_spec.h"

namespace landfall {

/// Horizontal distances between neighbouring returns of a scan, metres; NaN where there is none.
struct Spacings {
  std::vector<double> along;  ///< from each return to the next in time
  std::vector<double>
      across;  ///< of each sampled return (sample_of()) to the nearest across the scan direction
};

/// Spacing along and across the local scan direction, for any pattern. The direction at a return is that from
/// the return before it in time to the one behind it. `across` is the distance to the nearest return whose
/// direction differs from that by more than 45 degrees and less than 135. It is searched within 64 cells of
/// `cell_m` (> 0) for at most 8,192 returns. `places`: in the order of the times.
[[nodiscard]] Spacings spacings_of(std::span<const Horizontal> places, double cell_m);

}  // namespace landfall
