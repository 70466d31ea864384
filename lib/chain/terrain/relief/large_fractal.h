// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "chain/terrain/relief/fractal.h"
#include "chain/terrain/relief/fractal_spectrum.h"

namespace landfall {

/// A fractal on a grid that is too large for one transform, made in strips of rows. It has two bands, divided
/// sharply at L1 = 64 nodes, so that no wave counts twice:
/// - longer waves on a grid of every 8th node over the whole site, as add_fractal() makes them, interpolated
///   by cubic convolution (Keys 1981, a = -1/2);
/// - shorter ones in periodic patches of 512 x 512 nodes, each with draws of its own, that overlap by 128
///   nodes. There their weights are a sine and a cosine, whose squares sum to 1: the variance is kept.
///
/// The law and the longest wavelength are as in add_fractal(). An overlap, which mixes two patches, adds less
/// than 2 % to differences within the shorter band.
///
/// The values are a pure function of draw, parameters and grid: at any thread count, for any strips. Memory:
/// 0.4 bytes per node of the grid, and 32 kB for each of its columns.
class LargeFractal {
 public:
  LargeFractal(const FractalBase& fractal, const FractalDraw& draw, const GridSpec& grid,
               const ProgressCallback& progress = {});

  /// Adds the fractal to `strip`: some rows of the grid, all columns. Strips in order from south to north
  /// compute each patch once.
  void add_to(Grid<double>& strip, const ProgressCallback& progress = {});

 private:
  using PatchRow = std::vector<Grid<double>>;

  void make_long_waves(const ProgressCallback& progress);
  void add_long_waves(Grid<double>& strip) const;
  const PatchRow& patch_row(std::int64_t number, const ProgressCallback& progress);
  [[nodiscard]] Grid<double> patch(std::int64_t row, std::int64_t col) const;
  void add_patches(Grid<double>& strip, std::int64_t number, const PatchRow& patches) const;

  FractalBase fractal_;
  FractalDraw draw_;
  GridSpec grid_;
  double longest_m_;
  double patch_amplitude_;
  FractalSpectrum patch_spectrum_;
  Grid<double> long_waves_;                   ///< of node (8 (row - 1), 8 (col - 1)); empty without any
  std::map<std::int64_t, PatchRow> patches_;  ///< patches that the next strip may need
};

}  // namespace landfall
