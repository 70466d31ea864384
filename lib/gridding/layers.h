// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "gridding/bin_accumulator.h"
#include "raster/grid.h"

// The layers of a DEM, one at a time, so that no more than one need be in memory. Metres in frame D unless
// said otherwise. Every layer but the count is NaN where the bin is empty.

namespace landfall {

/// Where a bin's true elevation is taken.
enum class TruthAt {
  bin_center,  ///< under the true place of the bin's centre
  centroid,    ///< at the weighted mean of the true positions
};

/// H(x, y), metres, frame D; NaN off the terrain. Called from several threads at once.
using ElevationFunction = std::function<double(double x_m, double y_m)>;

/// Weighted mean elevation, Eq. 8: sum w z_est / sum w. Exact where all elevations of the bin are equal.
[[nodiscard]] Grid<double> z_est_layer(const BinAccumulator& bins);
/// Weighted means of the true positions, Eq. 9.
[[nodiscard]] Grid<double> x_true_layer(const BinAccumulator& bins);
[[nodiscard]] Grid<double> y_true_layer(const BinAccumulator& bins);
/// bin_center: H(X + dx, Y + dy), (X, Y) the bin's centre, dx = sum w (x_true - x_est) / sum w, dy likewise.
/// centroid: H(x_true, y_true). Also NaN off the terrain.
[[nodiscard]] Grid<double> z_true_layer(const BinAccumulator& bins, const ElevationFunction& elevation,
                                        TruthAt truth_at);
/// H(X, Y), the terrain under the bin's centre as the map has it; NaN off the terrain.
[[nodiscard]] Grid<float> z_true_map_layer(const BinAccumulator& bins, const ElevationFunction& elevation);
/// sum w.
[[nodiscard]] Grid<double> weight_sum_layer(const BinAccumulator& bins);
/// Returns in the bin; 0 where empty.
[[nodiscard]] Grid<std::int32_t> count_layer(const BinAccumulator& bins);
/// Weighted means of the estimated positions and of the time (s).
[[nodiscard]] Grid<float> x_est_mean_layer(const BinAccumulator& bins);
[[nodiscard]] Grid<float> y_est_mean_layer(const BinAccumulator& bins);
[[nodiscard]] Grid<float> t_mean_layer(const BinAccumulator& bins);
/// Weighted standard deviation of z_est: sqrt(sum w (z_est - mean)^2 / sum w); 0 for one return.
[[nodiscard]] Grid<float> z_spread_layer(const BinAccumulator& bins);

}  // namespace landfall
