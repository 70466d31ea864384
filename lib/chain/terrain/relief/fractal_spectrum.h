// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/raster/grid.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// Wavelengths in [from_m, below_m), metres. From 0: also those shorter than two nodes.
struct WaveBand {
  double from_m = 0;
  double below_m = std::numeric_limits<double>::infinity();
};

/// A periodic domain of `nodes` x `nodes`, spacing_m apart.
struct WaveDomain {
  double spacing_m = 1;
  std::int64_t nodes = 0;

  /// A domain at least twice the grid in both directions, of a size with a fast transform.
  [[nodiscard]] static WaveDomain around(const GridSpec& grid);
};

/// The factor of one wave's amplitude with which the waves of a domain add up to the law of `fractal`, whose
/// spectrum is S(k) = C k^-(2 H + 2), C = nu_0^2 L_0^(-2 H) 2^(2 H + 1) Gamma(1 + H)^2 sin(pi H), k in rad/m:
/// a wave has the variance S(k) / (area of the domain).
[[nodiscard]] double law_amplitude(const FractalBase& fractal, const WaveDomain& domain);

/// A wave between those of the domain, radians per node, and its power; so has its opposite.
struct LongWave {
  double kx = 0;
  double ky = 0;
  double power = 0;
};

/// The power spectrum |k|^-(2 H + 2) of a band on a periodic domain, k in radians per node, discretised so
/// that the structure function of the sum of all waves is that of the integral:
/// - Waves shorter than two nodes are folded: the nodes are samples of relief that has them. A band without
///   waves longer than two nodes (within 1e-6) is empty.
/// - A wave stands for its cell of the spectrum. Its power is the integral of |k|^2 times the spectrum over
///   the part of the cell that is in the band, divided by its own |k|^2.
/// - Waves near k = 0, where the spectrum varies most, are replaced by waves of a lattice three times as
///   fine, the innermost of these again, three times in all (subharmonics: Lane et al. 1992; Johansson and
///   Gavel 1994). What is longer is a plane.
///
/// Over a grid of half the domain, the structure function of all waves differs from the law by less than 1 %
/// at all distances, by less than 0.3 % up to a fifth of the grid; with a longest wavelength that is longer
/// than half the grid, by less than 3.5 % beyond that fifth.
class FractalSpectrum {
 public:
  FractalSpectrum(const WaveDomain& domain, const WaveBand& band, double hurst_exponent);

  [[nodiscard]] const WaveDomain& domain() const { return domain_; }
  /// Radians per node of wave i or j of the domain, -nodes / 2 < i <= nodes / 2.
  [[nodiscard]] double wave_number(std::int64_t i) const { return step_ * static_cast<double>(i); }
  /// The power of the wave (i, j) of the domain.
  [[nodiscard]] double power(std::int64_t i, std::int64_t j) const;
  [[nodiscard]] std::span<const LongWave> long_waves() const { return long_waves_; }
  /// The variance of the plane's slope on each axis, per node^2.
  [[nodiscard]] double slope_power() const { return slope_power_; }

 private:
  struct Cell {
    double kx = 0;
    double ky = 0;
    double edge = 0;
  };

  void tabulate_aliases();
  void add_long_waves();
  void set_slope();
  [[nodiscard]] bool in_band(double k2) const { return k2 > min_k2_ && k2 <= end_k2_; }
  [[nodiscard]] double cell_power(const Cell& cell) const;
  [[nodiscard]] double lattice_power(std::int64_t i, std::int64_t j) const;
  [[nodiscard]] double alias_power(double kx, double ky) const;

  WaveDomain domain_;
  double hurst_;
  double step_;    ///< radians per node between two waves
  double min_k2_;  ///< of the band, (radians per node)^2
  double end_k2_;
  std::vector<double> aliases_;  ///< by [kx][ky], 0 to pi; empty without waves shorter than two nodes
  std::vector<LongWave> long_waves_;
  double slope_power_ = 0;
};

}  // namespace landfall
