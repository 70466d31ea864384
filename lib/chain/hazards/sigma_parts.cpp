// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/sigma_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/raster/window_mean.h"

namespace landfall {
namespace {

/// Returns in a bin vary by more than the mean of 1 / sigma^2 suggests.
constexpr double kNoiseSpread = 1.3;

float root(double variance) { return static_cast<float>(std::sqrt(std::max(variance, 0.0))); }

}  // namespace

SigmaParts split_sigma(const Grid<double>& z_sigma, const Grid<double>& noise_sigma) {
  const GridSpec& spec = z_sigma.spec();
  SigmaParts parts{Grid<float>::unset(spec), Grid<float>::unset(spec)};
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const double sigma = z_sigma.values()[i];
    const double noise = noise_sigma.values()[i];
    const bool is_known = std::isfinite(sigma) && std::isfinite(noise);
    constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    parts.noise_m.values()[i] = is_known ? static_cast<float>(std::min(sigma, noise)) : kUnknown;
    parts.relief_m.values()[i] = is_known ? root(sigma * sigma - noise * noise) : kUnknown;
  }
  return parts;
}

SigmaParts split_sigma(const Grid<double>& z_sigma, const Footprint& window) {
  const GridSpec& spec = z_sigma.spec();
  Grid<double> typical(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const double sigma = z_sigma.values()[i];
    const double precision = 1 / (sigma * sigma);
    typical.values()[i] = std::isfinite(precision) ? precision : std::numeric_limits<double>::quiet_NaN();
  }
  typical = window_means(typical, window).mean;
  SigmaParts parts{Grid<float>::unset(spec), Grid<float>::unset(spec)};
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const double sigma = z_sigma.values()[i];
    const double noise = 1 / typical.values()[i];  // NaN where each sigma in the window is 0
    parts.noise_m.values()[i] =
        static_cast<float>(std::isnan(noise) ? sigma : std::min(sigma, std::sqrt(kNoiseSpread * noise)));
    parts.relief_m.values()[i] = std::isnan(sigma) ? std::numeric_limits<float>::quiet_NaN()
                                                   : root(std::isnan(noise) ? 0 : sigma * sigma - noise);
  }
  return parts;
}

}  // namespace landfall
