// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "raster/grid.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// Which draw of a fractal: layers of one seed are independent of each other.
struct FractalDraw {
  std::uint64_t seed = 1;
  std::uint64_t layer = 0;
};

/// Adds a realisation of fractional Brownian relief to `z` by spectral synthesis: one Gaussian amplitude per
/// wave of a periodic domain at least twice the grid in both directions, power |k|^-(2 H + 2).
///
/// Without a longest wavelength the amplitude is set so that the EXPECTED structure function equals
/// rms_deviation_m^2 (L / reference_length_m)^(2 H) at L = reference_length_m, mean of the two grid axes. A
/// reference length shorter than 4 nodes or longer than a twentieth of the domain is outside what the domain
/// can carry; the law is then met at the nearer of these two instead. The domain's mean is 0, the grid's is
/// not. The waves that the domain cannot hold are missing: lengths beyond a tenth of the grid are too smooth,
/// more so the larger H is.
///
/// With one, only shorter waves are made, each with the amplitude that it has in the full law
/// (law_amplitude()): nothing makes up for those that are left out.
///
/// A pure function of draw, parameters and grid, at any thread count. 16 bytes per node besides the grid,
/// O(n log n). A longest wavelength that is not set or infinite is none.
void add_fractal(Grid<double>& z, const FractalBase& fractal, const FractalDraw& draw,
                 const ProgressCallback& progress = {});

}  // namespace landfall
