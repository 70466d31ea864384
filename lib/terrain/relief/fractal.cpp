// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/relief/fractal.h"

#include <cmath>
#include <limits>

#include "terrain/relief/fractal_waves.h"

namespace landfall {
namespace {

/// The factor by which the waves of the whole domain are multiplied to meet the law at that lag.
double calibrated_amplitude(const FractalWaves& waves, const WaveDomain& domain, const FractalBase& fractal) {
  const double lag_nodes = calibration_lag(domain, fractal);
  return lawful_deviation_m(fractal, lag_nodes * domain.spacing_m) /
         std::sqrt(waves.squared_deviation(lag_nodes));
}

}  // namespace

void add_fractal(Grid<double>& z, const FractalBase& fractal, const FractalDraw& draw,
                 const ProgressCallback& progress) {
  const WaveDomain domain = WaveDomain::around(z.spec());
  const double longest_m = fractal.longest_wavelength_m.value_or(std::numeric_limits<double>::infinity());
  FractalWaves waves(domain, {0, longest_m}, fractal.hurst_exponent, z.spec().rows);
  const double amplitude =
      std::isinf(longest_m) ? calibrated_amplitude(waves, domain, fractal) : law_amplitude(fractal, domain);
  waves.draw(draw, [&](double fraction) { report(progress, fraction / 2); });
  waves.add_to(z, amplitude, [&](double fraction) { report(progress, 0.5 + fraction / 2); });
}

}  // namespace landfall
