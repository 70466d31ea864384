// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "base/progress.h"
#include "evaluation/dem_layers.h"
#include "evaluation/metrics.h"
#include "evaluation/window_quantile.h"

namespace landfall {

enum class Axis { x, y, z };

/// e = true - estimate of one axis (Eq. 10), every bin of the DEM: x_true - X, y_true - Y, z_true - z_est,
/// (X, Y) the bin's centre. NaN where either is NaN.
[[nodiscard]] Grid<double> error_of(Axis axis, const DemLayers& dem, const TrueLayers& truth);

/// Eqs. 11 and 12 of one axis, for the footprints centred on the region's bins; NaN elsewhere and where a
/// footprint has no valid bin.
struct FootprintStatistics {
  Grid<double> mean;      ///< of e
  Grid<double> relative;  ///< quantile of |e - mean|
};

struct FootprintShape {
  std::int64_t half_bins = 0;
  double quantile = 0.95;
};

[[nodiscard]] FootprintStatistics footprint_statistics(const Grid<double>& error, const BinMask& region,
                                                       const FootprintShape& shape,
                                                       const ProgressCallback& progress = {});

/// The summaries skip NaN and take values in row-major order, so the mean is the same on every machine.
[[nodiscard]] AbsoluteMetrics summarise_absolute(const Grid<double>& mean);
[[nodiscard]] RelativeMetrics summarise_relative(const Grid<double>& relative, double limit_m);
/// From hypot(mean_x, mean_y); within the limit means at most equal to it.
[[nodiscard]] HorizontalMetrics summarise_horizontal(const Grid<double>& horizontal, double limit_m);

/// hypot(mean_x, mean_y) per bin; NaN where either is. It takes the place of mean_x.
[[nodiscard]] Grid<double> horizontal_error(Grid<double> mean_x, const Grid<double>& mean_y);

}  // namespace landfall
