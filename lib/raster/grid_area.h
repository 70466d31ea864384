// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "raster/grid_spec.h"
#include "raster/horizontal.h"

namespace landfall {

/// A rectangle about a centre, of which both are multiples of the resolution.
struct GridArea {
  std::array<double, 2> half_width_m;  ///< along x and y
  Horizontal center_m;
};

/// Bin centres from center_m - half_width_m to center_m + half_width_m inclusive, along x and along y. For a
/// square about the origin GridSpec::centered(), whose errors are those of each axis; throws UsageError also
/// for a centre that is not a whole multiple of the resolution within 1e-9 bins. `what` begins the message.
[[nodiscard]] GridSpec grid_over(const GridArea& area, double resolution_m, const char* what);

}  // namespace landfall
