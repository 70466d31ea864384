// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "raster/grid.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// Identifies the draw of a fractal: layers of one seed are independent of each other.
struct FractalDraw {
  std::uint64_t seed = 1;
  std::uint64_t layer = 0;
};

/// Adds a realisation of fractional Brownian relief to `z` by spectral synthesis: one Gaussian amplitude per
/// wave of a periodic domain at least twice the grid in both directions, power |k|^-(2 H + 2).
///
/// Without a longest wavelength the amplitude is set so that the EXPECTED structure function equals
/// rms_deviation_m^2 (L / reference_length_m)^(2 H) at L = reference_length_m, mean of the two grid axes. The
/// domain cannot hold a reference length shorter than 4 nodes or longer than a twentieth of the domain; the
/// law is then met at the nearer of these two instead. The mean of the domain is 0, that of the grid is not.
/// Longer waves than the domain are missing: lengths beyond a tenth of the grid are too smooth, more so for
/// larger H.
///
/// With a longest wavelength, only shorter waves are made, each with its amplitude in the full law
/// (law_amplitude()). The omitted waves are not compensated for.
///
/// A pure function of draw, parameters and grid, at any thread count. 16 bytes per node besides the grid,
/// O(n log n). A longest wavelength that is not set or infinite means no limit.
void add_fractal(Grid<double>& z, const FractalBase& fractal, const FractalDraw& draw,
                 const ProgressCallback& progress = {});

}  // namespace landfall
