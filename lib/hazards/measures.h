// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "base/progress.h"
#include "hazards/lander.h"
#include "raster/grid.h"
#include "raster/region.h"

namespace landfall {

/// The angle of a plane to the horizontal, from its gradient.
[[nodiscard]] inline double slope_deg(double gradient) {
  return std::atan(gradient) * (180 / std::numbers::pi);
}

/// What a lander meets at each place of a map. A place is the bin under the lander's centre.
struct PlaceMeasures {
  Grid<double> slope_deg;    ///< the largest angle of a plane to the horizontal
  Grid<double> roughness_m;  ///< the largest height above a plane, along its normal; may be negative
};

/// The lander stands on the ground. Three legs give the plane of their pads. Of four legs the lander rests on
/// the diagonal whose pads are higher on average and rocks onto either of the two others: two planes, which
/// are one where the diagonals are equally high. A pad's height is that of the ground under it, at its bin's
/// centre. Roughness is the largest (z - plane) cos(slope) of the bins under the body. Both are the largest
/// over all yaws and planes, exact but for the rounding of one evaluation in double.
///
/// Places outside `places`, and those where a bin under a pad or the body, in any yaw, is NaN or lies outside
/// the map, are NaN. z in metres, finite or NaN. Parallel by rows.
[[nodiscard]] PlaceMeasures measure_contact(const Grid<double>& z, const LanderStencil& lander,
                                            const BinMask& places, const ProgressCallback& progress = {});

/// The least-squares plane of the bins under the body; roughness is the largest |z - plane| cos(slope). As
/// measure_contact() otherwise, without pads.
[[nodiscard]] PlaceMeasures measure_plane(const Grid<double>& z, const LanderStencil& lander,
                                          const BinMask& places, const ProgressCallback& progress = {});

}  // namespace landfall
