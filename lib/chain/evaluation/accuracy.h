// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/core/progress.h"
#include "chain/evaluation/dem_layers.h"
#include "chain/evaluation/metrics.h"
#include "chain/evaluation/quantile/window_quantile.h"

namespace landfall {

enum class Axis { x, y, z };

/// e = true - estimate of one axis (Eq. 10) in every bin of the DEM: x_true - X, y_true - Y, z_true - z_est,
/// (X, Y) the bin's centre. NaN where either is NaN. A truth that is moved in lends its memory to the result.
[[nodiscard]] Grid<double> error_of(Axis axis, Grid<double> truth, const Grid<double>& z_est);

/// The errors of a DEM, each on its grid.
struct ErrorLayers {
  Grid<double> x, y, z;
  std::optional<Grid<double>> corrected;  ///< z_true less the corrected elevation
};
[[nodiscard]] ErrorLayers errors_of(TrueLayers truth, const Grid<double>& z_est,
                                    std::optional<Grid<double>> corrected = std::nullopt);

/// Eqs. 11 and 12 of one axis for the footprints centred on the region's bins; NaN elsewhere and where a
/// footprint has no valid bin.
struct FootprintStatistics {
  Grid<double> mean;      ///< of e
  Grid<double> relative;  ///< quantile of |e - mean|
};

struct FootprintRule {
  Footprint footprint;
  std::optional<double> quantile = 0.95;  ///< without one relative errors are NaN
};

/// The rule of an evaluation.
[[nodiscard]] FootprintRule footprint_rule(const EvaluationParameters& parameters, double resolution_m);

[[nodiscard]] FootprintStatistics footprint_statistics(const Grid<double>& error, const BinMask& region,
                                                       const FootprintRule& rule,
                                                       const ProgressCallback& progress = {});

/// The summaries skip NaN and sum in a fixed order, so the mean is the same on every machine.
[[nodiscard]] AbsoluteMetrics summarise_absolute(const Grid<double>& mean);
[[nodiscard]] RelativeMetrics summarise_relative(const Grid<double>& relative, double limit_m);
/// From hypot(mean_x, mean_y). A footprint at most equal to the limit is within it.
[[nodiscard]] HorizontalMetrics summarise_horizontal(const Grid<double>& horizontal, double limit_m);

/// hypot(x, y) per bin; NaN where either is. The result replaces x.
[[nodiscard]] Grid<double> horizontal_error(Grid<double> x, const Grid<double>& y);

}  // namespace landfall
