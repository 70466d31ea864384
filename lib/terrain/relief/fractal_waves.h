// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/progress.h"
#include "base/random.h"
#include "raster/grid.h"
#include "terrain/relief/fractal.h"

namespace landfall {

/// Wavelengths in [from_m, below_m), metres.
struct WaveBand {
  double from_m = 0;
  double below_m = std::numeric_limits<double>::infinity();
};

/// A periodic domain of nx x ny nodes, spacing_m apart.
struct WaveDomain {
  double spacing_m = 1;
  std::int64_t nx = 0;
  std::int64_t ny = 0;

  /// A domain at least twice the grid in both directions, of a size with a fast transform.
  [[nodiscard]] static WaveDomain around(const GridSpec& grid);
};

/// The factor of one wave's amplitude with which the waves of a domain add up to the law of `fractal`, whose
/// spectrum is S(k) = C k^-(2 H + 2), C = nu_0^2 L_0^(-2 H) 2^(2 H + 1) Gamma(1 + H)^2 sin(pi H), k in rad/m:
/// a wave has the variance S(k) / (area of the domain).
[[nodiscard]] double law_amplitude(const FractalBase& fractal, const WaveDomain& domain);

/// rms_deviation_m (lag_m / reference_length_m)^H, metres.
[[nodiscard]] double lawful_deviation_m(const FractalBase& fractal, double lag_m);

/// The lag, in nodes, at which a single domain meets the law: the reference length, but not shorter than 4
/// nodes nor longer than a twentieth of the domain.
[[nodiscard]] double calibration_lag(const WaveDomain& domain, const FractalBase& fractal);

/// A realisation of the waves of a band on a periodic domain: one Gaussian amplitude per wave, power |k|^-(2
/// H + 2) with k in radians per node. Only the first rows of the domain are kept.
class FractalWaves {
 public:
  /// `rows`: the number of rows that are kept.
  FractalWaves(const WaveDomain& domain, const WaveBand& band, double hurst_exponent, std::int64_t rows);

  /// Draws the waves and transforms along y. 16 bytes per kept row and half the columns of the domain.
  void draw(const FractalDraw& draw, const ProgressCallback& progress = {});
  /// Transforms along x and adds the field, times `factor`, to a grid of the nodes that are kept.
  void add_to(Grid<double>& z, double factor, const ProgressCallback& progress = {}) const;

  /// The expected squared difference of nodes `lag_nodes` apart, mean of both axes, for the factor 1.
  [[nodiscard]] double squared_deviation(double lag_nodes) const;

 private:
  using Complex = std::complex<double>;

  [[nodiscard]] double wave_x(std::size_t i) const;
  [[nodiscard]] double wave_y(std::int64_t j) const;
  [[nodiscard]] double power(double k2) const;
  [[nodiscard]] std::vector<double> column_powers(std::size_t i) const;
  /// Columns 0 and nx/2 are their own mirror images; every other column represents two.
  [[nodiscard]] bool own_mirror(std::size_t i) const { return i == 0 || i + 1 == columns_; }
  void draw_column(std::size_t i, const RandomField& random, std::uint64_t layer,
                   std::vector<Complex>& column) const;
  void draw_columns(std::size_t begin, std::size_t end, const FractalDraw& draw);
  void add_rows(Grid<double>& z, double factor, std::size_t begin, std::size_t end) const;

  WaveDomain domain_;
  double hurst_;
  double least_k2_;  ///< of the band, (radians per node)^2
  double end_k2_;
  std::int64_t rows_;
  std::size_t columns_;
  std::vector<Complex> partial_;  ///< column by column, the kept rows
};

}  // namespace landfall
