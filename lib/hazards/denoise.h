// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "raster/footprint.h"
#include "raster/grid.h"

namespace landfall {

/// What the 1 sigma of a bin stands for. A bin of a DEM is the mean of a few returns: their noise, and the
/// ground within the bin, which differs from its mean.
struct SigmaParts {
  Grid<double> noise_m;   ///< of the mean; independent of the other bins
  Grid<double> relief_m;  ///< of the ground in the bin; 0 where sigma is that of noise
};

/// Noise is much the same all over a window, and relief is in few of its bins. With 1/m the mean of 1/sigma^2
/// in the window about a bin, noise^2 = min(sigma^2, 1.3 m), since the number of returns varies, and relief^2
/// = max(sigma^2 - m, 0). Equal sigmas are noise. NaN where sigma is.
[[nodiscard]] SigmaParts split_sigma(const Grid<double>& z_sigma, const Footprint& window);

/// What sigma^2 of a bin exceeds noise_m^2 by, from the parts that split_sigma() makes of it.
[[nodiscard]] double beyond_noise(double relief_variance, double noise_m);

/// Weighs each bin against the quadratic surface through the 24 bins around it, which does not use the bin
/// itself. The variance of the surface is that of the noise in it plus the terrain's departure from it: the
/// mean over 3 x 3 bins of the squared misfit beyond what noise explains. So noise is averaged where the
/// ground is smooth, and an edge stays as it was measured. A bin stays, too, where one of the bins involved
/// is not finite or off the map. `noise_m` is the 1 sigma of each bin, independent of the others.
[[nodiscard]] Grid<double> denoise(const Grid<double>& z, const Grid<double>& noise_m);

/// The ground at the centres of bins that hold its means: each less an eighth of its curvature, which is what
/// the mean over a bin adds to ground that is linear between the centres,
///   z - (sum of the four neighbours - 4 z) / 8,
/// the bracket being averaged over 3 x 3 bins and the change being at most `relief_m`. A bin stays where one
/// of the bins involved is not finite or off the map.
[[nodiscard]] Grid<double> sharpen(const Grid<double>& z, const Grid<double>& relief_m);

}  // namespace landfall
