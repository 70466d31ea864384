// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/raster/footprint.h"
#include "base/raster/grid.h"

namespace landfall {

/// The parts of the 1 sigma of a bin. A bin of a DEM is the mean of a few returns: their noise, and the
/// ground within the bin, which differs from its mean. NaN where the bin has no sigma.
struct SigmaParts {
  Grid<float> noise_m;   ///< of the mean; independent of the other bins
  Grid<float> relief_m;  ///< of the ground in the bin; 0 where sigma is that of noise
};

/// With known noise: relief^2 = max(sigma^2 - noise^2, 0).
[[nodiscard]] SigmaParts split_sigma(const Grid<double>& z_sigma, const Grid<double>& noise_sigma);

/// Without: noise is much the same all over a window, and relief is in few of its bins. With 1/m the
/// mean of 1/sigma^2 in the window about a bin, noise^2 = min(sigma^2, 1.3 m), since the number of returns
/// varies, and relief^2 = max(sigma^2 - m, 0). Equal sigmas are noise. Ground that is rough all over is taken
/// for noise.
[[nodiscard]] SigmaParts split_sigma(const Grid<double>& z_sigma, const Footprint& window);

}  // namespace landfall
