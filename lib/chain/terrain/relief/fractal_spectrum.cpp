// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D20, D253
#include "chain/terrain/relief/fractal_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::int64_t kReplaced = 1;  // waves (i, j) of up to this i and j are replaced by finer ones
constexpr int kRefinements = 3;
constexpr std::int64_t kIntegrated = 12;  // waves (i, j) of up to this i or j are integrated over their cell
constexpr int kSamples = 8;               // per edge of an integrated cell
constexpr std::int64_t kAliasSteps = 64;  // of the table
constexpr int kAliases = 2;               // on each side that are added one by one

/// Small prime factors make the FFT fast; a multiple of 4 enables the fast real transform.
std::int64_t next_fft_size(std::int64_t minimum) {
  for (std::int64_t size = (minimum + 3) / 4 * 4;; size += 4) {
    std::int64_t rest = size;
    for (const std::int64_t prime : {2, 3, 5})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return size;
  }
}

double square(double value) { return value * value; }

/// The integral of f(r(theta)) over all directions theta, r the distance from the middle of a square to its
/// border, half_edge at the least.
template <class F>
double over_directions(double half_edge, const F& f) {
  constexpr int kSteps = 256;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f(half_edge / portable::cos(kPi / 4 * (i + 0.5) / kSteps));
  return sum * 2 * kPi / kSteps;
}

}  // namespace

WaveDomain WaveDomain::around(const GridSpec& grid) {
  return {grid.resolution_m, next_fft_size(2 * std::max(grid.rows, grid.cols))};
}

double law_amplitude(const FractalBase& fractal, const WaveDomain& domain) {
  const double hurst = fractal.hurst_exponent;
  const double constant =
      portable::exp2(2 * hurst + 1) * square(portable::gamma(1 + hurst)) * portable::sin(kPi * hurst);
  const double deviation_m =
      fractal.rms_deviation_m * portable::pow(domain.spacing_m / fractal.reference_length_m, hurst);
  return deviation_m * std::sqrt(constant) / static_cast<double>(domain.nodes);
}

FractalSpectrum::FractalSpectrum(const WaveDomain& domain, const WaveBand& band, double hurst_exponent)
    : domain_(domain),
      hurst_(hurst_exponent),
      step_(2 * kPi / static_cast<double>(domain.nodes)),
      min_k2_(square(2 * kPi * domain.spacing_m / band.below_m)),
      end_k2_(square(2 * kPi * domain.spacing_m / band.from_m)) {
  if (band.from_m == 0) {
    // A raster as fine as the grid leaves no waves, although its posting may be rounded.
    if (min_k2_ * square(1 + 1e-6) > square(kPi))
      end_k2_ = 0;
    else
      tabulate_aliases();
  }
  add_long_waves();
  set_slope();
}

/// The aliases, at a node's samples, of the wave (kx, ky), from 0 to pi. Far ones are an integral.
void FractalSpectrum::tabulate_aliases() {
  const double rest =
      over_directions((2 * kAliases + 1) * kPi,
                      [&](double k) { return portable::pow(k, -2 * hurst_) / (2 * hurst_); }) /
      square(2 * kPi);
  const auto at = [](std::int64_t a, std::int64_t b) {
    return static_cast<std::size_t>(a * (kAliasSteps + 1) + b);
  };
  aliases_.resize(at(kAliasSteps, kAliasSteps) + 1);
  for (std::int64_t a = 0; a <= kAliasSteps; ++a)
    for (std::int64_t b = 0; b <= a; ++b) {
      const double kx = kPi * static_cast<double>(a) / kAliasSteps;
      const double ky = kPi * static_cast<double>(b) / kAliasSteps;
      double sum = rest;
      for (int m = -kAliases; m <= kAliases; ++m)
        for (int n = -kAliases; n <= kAliases; ++n)
          if (m != 0 || n != 0)
            sum += portable::pow(square(kx + 2 * kPi * m) + square(ky + 2 * kPi * n), -(hurst_ + 1));
      aliases_[at(a, b)] = aliases_[at(b, a)] = sum;
    }
}

double FractalSpectrum::alias_power(double kx, double ky) const {
  if (aliases_.empty()) return 0;
  const double x = std::abs(kx) / kPi * kAliasSteps;
  const double y = std::abs(ky) / kPi * kAliasSteps;
  const auto a = std::min<std::int64_t>(static_cast<std::int64_t>(x), kAliasSteps - 1);
  const auto b = std::min<std::int64_t>(static_cast<std::int64_t>(y), kAliasSteps - 1);
  const double u = x - static_cast<double>(a);
  const double v = y - static_cast<double>(b);
  const double* const at = &aliases_[static_cast<std::size_t>(a * (kAliasSteps + 1) + b)];
  return (1 - u) * ((1 - v) * at[0] + v * at[1]) +
         u * ((1 - v) * at[kAliasSteps + 1] + v * at[kAliasSteps + 2]);
}

double FractalSpectrum::cell_power(const Cell& cell) const {
  double sum = 0;
  for (int a = 0; a < kSamples; ++a)
    for (int b = 0; b < kSamples; ++b) {
      const double kx = cell.kx + cell.edge * ((a + 0.5) / kSamples - 0.5);
      const double ky = cell.ky + cell.edge * ((b + 0.5) / kSamples - 0.5);
      const double k2 = kx * kx + ky * ky;
      if (in_band(k2)) sum += portable::pow(k2, -hurst_);
    }
  return sum / (kSamples * kSamples) / (cell.kx * cell.kx + cell.ky * cell.ky);
}

double FractalSpectrum::lattice_power(std::int64_t i, std::int64_t j) const {
  const double kx = wave_number(i);
  const double ky = wave_number(j);
  const double k2 = kx * kx + ky * ky;
  const double k = std::sqrt(k2);
  const auto is_cut = [&](double limit_k2) { return std::abs(k - std::sqrt(limit_k2)) < step_; };
  if (std::max(std::abs(i), std::abs(j)) <= kIntegrated || is_cut(min_k2_) || is_cut(end_k2_))
    return cell_power({kx, ky, step_});
  if (!in_band(k2)) return 0;
  // The mean of k^-2H over a cell, to the second order.
  return portable::pow(k2, -(hurst_ + 1)) * (1 + square(hurst_ * step_) / (6 * k2));
}

double FractalSpectrum::power(std::int64_t i, std::int64_t j) const {
  const bool is_replaced = std::max(std::abs(i), std::abs(j)) <= kReplaced;
  return (is_replaced ? 0 : lattice_power(i, j)) + alias_power(wave_number(i), wave_number(j));
}

void FractalSpectrum::add_long_waves() {
  constexpr std::int64_t kEnd = 3 * kReplaced + 1;
  double edge = step_;
  for (int level = 0; level < kRefinements; ++level) {
    edge /= 3;
    for (std::int64_t a = 0; a <= kEnd; ++a)
      for (std::int64_t b = a == 0 ? 1 : -kEnd; b <= kEnd; ++b) {
        if (std::max(a, std::abs(b)) <= kReplaced) continue;
        const Cell cell{edge * static_cast<double>(a), edge * static_cast<double>(b), edge};
        const double power = cell_power(cell) * square(edge / step_);
        if (power > 0) long_waves_.push_back({cell.kx, cell.ky, power});
      }
  }
}

void FractalSpectrum::set_slope() {
  const double exponent = 2 - 2 * hurst_;
  const double minimum = std::sqrt(std::min(min_k2_, end_k2_));
  const auto longer = [&](double k) {
    return (portable::pow(k, exponent) - portable::pow(std::min(minimum, k), exponent)) / exponent;
  };
  const double half_edge = step_ / portable::pow(3, kRefinements) * (kReplaced + 0.5);
  if (end_k2_ > 0) slope_power_ = over_directions(half_edge, longer) / (2 * square(step_));
}

}  // namespace landfall
