// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "chain/gridding/weighted_mean_accumulator.h"

namespace landfall {

/// The surface's gradient at a bin, dz/dx and dz/dy.
struct Slope {
  float x = std::numeric_limits<float>::quiet_NaN();
  float y = std::numeric_limits<float>::quiet_NaN();
};

/// A plane fitted to the centroids of the bins around a bin.
struct PlaneFit {
  Slope slope;
  double misfit_m2 = 0;     ///< mean square of the centroids' vertical distances, with the weights of the fit
  int bins = 0;             ///< centroids; 0: no plane
  std::int64_t radius = 0;  ///< they lie in (2 radius + 1)^2 bins
};

/// The plane at a bin that holds a return, fitted by least squares, weighted by sum w, to the centroids (mean
/// x_est, mean y_est, z_est) of the 3 x 3 bins around it. With centroids instead of bin centres, the slope of
/// a plane is exact for any position of the returns.
///
/// If fewer than 6 of those bins hold returns, or they are so nearly collinear that their scatter across the
/// line is below 0.1 s^2 (s the bin's edge; 2/3 s^2 for 3 x 3 full bins), 5 x 5 bins are used, then 7 x 7.
/// No plane is returned if even these have fewer than 3 bins or are collinear. Range noise sigma_z of a bin
/// gives the slope the noise sigma_z / (s sqrt(6)) on each axis.
[[nodiscard]] PlaneFit fit_plane(const WeightedMeanAccumulator& bins, BinIndex bin);

/// The slopes of these planes; NaN where there is none, and in empty bins.
[[nodiscard]] Grid<Slope> slope_layer(const WeightedMeanAccumulator& bins,
                                      const ProgressCallback& progress = {});

/// z_est - g . D: z_est moved along the slope g from the centroid of the bin's returns to the bin's centre; D
/// = (mean x_est - X, mean y_est - Y). On a plane this removes the quantisation error (Eq. 13) completely.
/// NaN where z_est or the slope is NaN.
[[nodiscard]] double corrected_elevation(const BinValues& values, const GridSpec& spec, BinIndex bin,
                                         const Slope& slope);

}  // namespace landfall
