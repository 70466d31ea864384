// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <numbers>

#include "base/core/progress.h"
#include "base/numerics/portable_math.h"
#include "base/raster/grid.h"
#include "base/raster/region.h"
#include "chain/hazards/lander.h"

namespace landfall {

/// The angle of a plane to the horizontal, from its gradient.
[[nodiscard]] inline double slope_deg(double gradient) {
  return portable::atan(gradient) * (180 / std::numbers::pi);
}

/// Slope and roughness that a lander meets at each place of a map. A place is the bin under the lander's
/// centre.
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

/// Windows of measure_range_difference(): squares of 2 half + 1 bins, each half >= 1.
struct RangeWindows {
  std::int64_t lander_half_bins;  ///< of the body
  std::int64_t rock_half_bins;
};

/// Whole bins in the radius of a rock that is a hemisphere of this height.
[[nodiscard]] std::int64_t rock_half_bins(double height_m, double resolution_m);

/// The differences of ranges in windows of the simple safe site selection (S4) by A. E. Johnson and A. B.
/// Mandalia, NASA Tech Briefs NPO-49440. Of the map after a 3 x 3 median filter,
///   SDR  = max - min over the square about the body, h bins to each side,
///   RDR  = max - min over a square as wide as a rock, SRDR = max of RDR over the square about the body,
///   slope = atan(SDR / (2 h s)), roughness = SRDR.
/// On a plane that rises along x or y the slope is exact; along a diagonal its tangent is sqrt(2) times the
/// true one, never less anywhere. The rise of a plane over the rock's window also counts as roughness. A
/// place is known where all bins that enter are finite: h + the rock's half window + 1 to each side. O(1) per
/// bin for any window.
[[nodiscard]] PlaceMeasures measure_range_difference(const Grid<double>& z, const RangeWindows& windows,
                                                     const BinMask& places,
                                                     const ProgressCallback& progress = {});

/// The plane with the least median of squared residuals (P. J. Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871),
/// as A. E. Johnson, A. R. Klumpp, J. B. Collier and A. A. Wolf propose for hazards (J. Guidance, Control,
/// and Dynamics 25(6), 2002): up to half of the bins may lie on rocks without an influence on it.
///
/// Candidates are the planes through 35 triples of samples: with half of them outliers, one triple has none
/// with a probability of 1 - (1 - 0.5^3)^35 = 0.99. Samples are the bins under the body whose row and column,
/// counted from the place, are multiples of max(1, floor(body's half width / 4)): 49 to 149 from a half width
/// of 4 on. Triples, from a fixed seed, are the same at every place. The residual is z - plane. A plane
/// replaces that of an earlier triple if its median is smaller by more than 1e-9 m. Roughness is the largest
/// |z - plane| cos(slope) of all bins under the body, which reaches at least 2. As measure_plane() otherwise.
[[nodiscard]] PlaceMeasures measure_lmeds(const Grid<double>& z, const LanderStencil& lander,
                                          const BinMask& places, const ProgressCallback& progress = {});

}  // namespace landfall
