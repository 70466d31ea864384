// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/fractal.h"

#include <limits>

#include "chain/terrain/relief/fractal_waves.h"

namespace landfall {

void add_fractal(Grid<double>& z, const FractalBase& fractal, const FractalDraw& draw,
                 const ProgressCallback& progress) {
  const WaveDomain domain = WaveDomain::around(z.spec());
  const double longest_m = fractal.longest_wavelength_m.value_or(std::numeric_limits<double>::infinity());
  const FractalSpectrum spectrum(domain, {0, longest_m}, fractal.hurst_exponent);
  FractalWaves waves(spectrum, z.spec().rows);
  waves.draw(draw, [&](double fraction) { report(progress, fraction / 2); });
  waves.add_to(z, law_amplitude(fractal, domain),
               [&](double fraction) { report(progress, 0.5 + fraction / 2); });
}

}  // namespace landfall
