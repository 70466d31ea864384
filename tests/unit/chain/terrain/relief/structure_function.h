// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/raster/grid.h"
#include "bins.h"
#include "chain/terrain/terrain_model.h"

namespace landfall {

/// Without std::pow, which costs a call where tests are compiled with -Og.
inline double squared_step(double a, double b) { return (a - b) * (a - b); }

/// Mean squared elevation difference at a lag, along both axes.
inline double squared_deviation(const Grid<double>& z, std::int64_t lag) {
  double sum = 0;
  std::int64_t count = 0;
  const GridSpec& spec = z.spec();
  for (const auto [r, c] : bins_of(spec)) {
    if (c + lag < spec.cols) sum += squared_step(z.at({r, c + lag}), z.at({r, c})), ++count;
    if (r + lag < spec.rows) sum += squared_step(z.at({r + lag, c}), z.at({r, c})), ++count;
  }
  return sum / static_cast<double>(count);
}

/// The mean over seeds of a squared deviation, in units of its law, and the standard error of this mean.
struct Ratio {
  double mean = 0;
  double error = 0;
};

/// For each lag, realisations make(1) to make(seeds) against the law without a longest wavelength.
template <class Make>
std::vector<Ratio> squared_ratios(const FractalBase& law, const std::vector<std::int64_t>& lags, int seeds,
                                  const Make& make) {
  std::vector<double> sums(lags.size());
  std::vector<double> squares(lags.size());
  for (int seed = 1; seed <= seeds; ++seed) {
    const Grid<double> z = make(static_cast<std::uint64_t>(seed));
    for (std::size_t i = 0; i < lags.size(); ++i) {
      const double length_m = static_cast<double>(lags[i]) * z.spec().resolution_m;
      const double lawful_m =
          law.rms_deviation_m * std::pow(length_m / law.reference_length_m, law.hurst_exponent);
      const double ratio = squared_deviation(z, lags[i]) / (lawful_m * lawful_m);
      sums[i] += ratio;
      squares[i] += ratio * ratio;
    }
  }
  std::vector<Ratio> ratios;
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double mean = sums[i] / seeds;
    ratios.push_back({mean, std::sqrt((squares[i] / seeds - mean * mean) / (seeds - 1))});
  }
  return ratios;
}

}  // namespace landfall
