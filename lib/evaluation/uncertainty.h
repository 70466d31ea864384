// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "evaluation/footprint.h"
#include "evaluation/metrics.h"
#include "evaluation/region.h"

namespace landfall {

/// A DEM's own account of its errors, layers of one grid.
struct UncertaintyLayers {
  Grid<double> error;  ///< of the cell as a map reader meets it: H(X, Y) - z_est, metres; NaN where unknown
  Grid<float> sigma_abs;                    ///< its 1-sigma
  Grid<float> sigma_rel;                    ///< the same without what is common to a footprint
  std::optional<Grid<std::int32_t>> count;  ///< returns per bin
};

/// Judges the 1-sigma maps by z-scores, error over sigma, of the region's bins.
///
/// - absolute: the error against sigma_abs;
/// - relative: the error less its mean over the footprint (Eq. 11, clipped, NaN ignored) against sigma_rel. A
///   mean of n bins holds the bin itself, which shrinks independent errors by sqrt(1 - 1/n): 0.04 % for 1225
///   bins, 29 % for two. Nothing is made up for; a footprint of one valid bin says nothing and is left out.
///
/// Left out and counted are bins with an error but a sigma that is NaN, infinite or not positive. Bins are
/// taken in row-major order: the numbers do not depend on the number of threads.
///
/// Throws FormatError when grids differ.
[[nodiscard]] UncertaintyMetrics assess_uncertainty(const UncertaintyLayers& layers, const BinMask& region,
                                                    const Footprint& footprint);

}  // namespace landfall
