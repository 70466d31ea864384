// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "base/core/progress.h"
#include "base/numerics/random.h"
#include "base/raster/grid.h"
#include "chain/terrain/relief/fractal.h"
#include "chain/terrain/relief/fractal_spectrum.h"

namespace landfall {

/// A realisation of a spectrum: two Gaussian amplitudes per wave. Only the first rows of the domain are kept.
/// Waves longer than the domain, and the plane, are 0 in the middle of the grid: heights between distant
/// places matter, the height above a mean of waves far longer than the grid does not.
class FractalWaves {
 public:
  /// `spectrum` must outlive this; `rows`: the number of rows that are kept.
  FractalWaves(const FractalSpectrum& spectrum, std::int64_t rows);

  /// Draws the waves and transforms along y. 16 bytes per kept row and half the columns of the domain.
  void draw(const FractalDraw& draw, const ProgressCallback& progress = {});
  /// Transforms along x and adds the field, times `factor`, to a grid of the nodes that are kept.
  void add_to(Grid<double>& z, double factor, const ProgressCallback& progress = {}) const;

 private:
  using Complex = std::complex<double>;

  /// A long wave with its amplitudes: cosine cos(k . r) + sine sin(k . r), r from the middle of the grid.
  struct DrawnWave {
    double kx = 0;
    double ky = 0;
    double cosine = 0;
    double sine = 0;
  };
  class LongRows;

  [[nodiscard]] std::int64_t nodes() const { return spectrum_.domain().nodes; }
  /// Columns 0 and nodes / 2 are their own mirror images; every other column represents two.
  [[nodiscard]] bool own_mirror(std::size_t i) const { return i == 0 || i + 1 == columns_; }
  void draw_column(std::size_t i, const RandomField& random, std::uint64_t layer,
                   std::vector<Complex>& column) const;
  void draw_columns(std::size_t begin, std::size_t end, const FractalDraw& draw);
  void draw_long_waves(const FractalDraw& draw);
  void add_rows(Grid<double>& z, double factor, std::size_t begin, std::size_t end) const;

  const FractalSpectrum& spectrum_;
  std::int64_t rows_;
  std::size_t columns_;
  std::vector<Complex> partial_;  ///< column by column, the kept rows
  std::vector<DrawnWave> long_waves_;
  double slope_x_ = 0;  ///< of the plane, per node
  double slope_y_ = 0;
};

}  // namespace landfall
