// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/raster/region.h"
#include "chain/evaluation/metrics.h"

namespace landfall {

/// Statistics of the errors of the region's bins that are not NaN: mean, standard deviation (divided by the
/// count, so that rmse^2 = mean^2 + std^2), root mean square, median, NMAD = 1.4826 median |e - median|
/// (Hoehle and Hoehle 2009: equal to the standard deviation for normal errors and robust to outliers), LE90
/// and p95, the 0.90 and 0.95 quantiles of |e|. Quantiles as in quantile.h; sums in a fixed order.
[[nodiscard]] ErrorStatistics error_statistics(const Grid<double>& error, const BinMask& region);

/// Statistics of horizontal errors, hypot(e_x, e_y): CE90, the 0.90 quantile, and the root mean square.
[[nodiscard]] HorizontalStatistics horizontal_statistics(const Grid<double>& horizontal,
                                                         const BinMask& region);

}  // namespace landfall
