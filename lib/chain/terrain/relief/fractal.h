// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/core/progress.h"
#include "base/numerics/random_seed.h"
#include "base/raster/grid.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// Identifies the draw of a fractal: layers of one seed are independent of each other.
struct FractalDraw {
  RandomSeed seed = {};
  std::uint64_t layer = 0;
};

/// Adds a realisation of fractional Brownian relief to `z` by spectral synthesis: the waves of a periodic
/// domain at least twice the grid in both directions, those between them and a plane (FractalSpectrum).
///
/// The expected structure function of the nodes, their mean squared difference at the distance L, equals
/// rms_deviation_m^2 (L / reference_length_m)^(2 H) within 2 % from one node to the width of the grid, in all
/// directions. With a longest wavelength only shorter waves are made, each with its amplitude in the full
/// law, and the structure function is that of these waves. Waves longer than the domain are 0 at the middle
/// of the grid. The mean of the others is 0 over the domain, not over the grid.
///
/// A pure function of draw, parameters and grid, at any thread count. 16 bytes per node besides the grid,
/// O(n log n). A longest wavelength that is not set or infinite means no limit.
void add_fractal(Grid<double>& z, const FractalBase& fractal, const FractalDraw& draw,
                 const ProgressCallback& progress = {});

}  // namespace landfall
