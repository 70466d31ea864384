// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

#include "chain/terrain/terrain_model.h"

namespace landfall {

/// The structure function of the law with only waves shorter than `longest_m`:
/// (C / pi) integral of k^(-2 H - 1) (1 - J0(k L)) over k > 2 pi / longest_m, C of law_amplitude(). Computed
/// by Simpson's rule in log k, and beyond k = 1e4 / L, where J0 is negligible, in closed form.
inline double band_deviation_m(const FractalBase& law, double longest_m, double lag_m) {
  const double hurst = law.hurst_exponent;
  const double gamma = std::tgamma(1 + hurst);
  const double constant = std::pow(law.rms_deviation_m, 2) * std::pow(law.reference_length_m, -2 * hurst) *
                          std::pow(2, 2 * hurst + 1) * gamma * gamma * std::sin(std::numbers::pi * hurst);
  const double first = std::log(2 * std::numbers::pi / longest_m);
  const double last = std::log(1e4 / lag_m);
  constexpr int kPieces = 40000;
  double sum = 0;
  for (int i = 0; i <= kPieces; ++i) {
    const double k = std::exp(first + (last - first) * i / kPieces);
    const double weight = i == 0 || i == kPieces ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * std::pow(k, -2 * hurst) * (1 - ::j0(k * lag_m));
  }
  const double integral = sum * (last - first) / kPieces / 3;
  const double rest = std::exp(-2 * hurst * last) / (2 * hurst);
  return std::sqrt(constant / std::numbers::pi * (integral + rest));
}

}  // namespace landfall
