// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/raster/footprint.h"
#include "base/raster/region.h"
#include "chain/evaluation/metrics.h"

namespace landfall {

/// A DEM's own estimate of its errors, as layers of one grid.
struct UncertaintyLayers {
  Grid<double> error;     ///< error of the cell for a map reader: H(X, Y) - z_est, metres; NaN where unknown
  Grid<float> sigma_abs;  ///< its 1-sigma
  Grid<float> sigma_rel;  ///< the 1-sigma without the errors common to a footprint
  std::optional<Grid<std::int32_t>> count;  ///< returns per bin
};

/// Compares the 1-sigma maps with the errors of the region's bins by z-scores, error over sigma.
///
/// - absolute: the error against sigma_abs;
/// - relative: the error minus its mean over the footprint (Eq. 11, clipped, NaN ignored) against sigma_rel.
///   A mean of n bins includes the bin itself, which reduces independent errors by sqrt(1 - 1/n): 0.04 % for
///   1225 bins, 29 % for two. This is not corrected; a footprint with a single valid bin is skipped.
///
/// Bins with an error but a sigma that is NaN, infinite or not positive are skipped and counted. Bins are
/// processed in row-major order: the numbers do not depend on the number of threads.
///
/// Throws FormatError if grids differ.
[[nodiscard]] UncertaintyMetrics assess_uncertainty(const UncertaintyLayers& layers, const BinMask& region,
                                                    const Footprint& footprint);

}  // namespace landfall
