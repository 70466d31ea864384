// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/relief/fractal_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "base/parallel.h"

namespace landfall {
namespace {

/// Small prime factors make the FFT fast; a multiple of 4 enables the fast real transform.
std::int64_t next_fft_size(std::int64_t least) {
  for (std::int64_t size = (least + 3) / 4 * 4;; size += 4) {
    std::int64_t rest = size;
    for (const std::int64_t prime : {2, 3, 5})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return size;
  }
}

double square(double value) { return value * value; }

}  // namespace

WaveDomain WaveDomain::around(const GridSpec& grid) {
  return {grid.resolution_m, next_fft_size(2 * grid.cols), next_fft_size(2 * grid.rows)};
}

double law_amplitude(const FractalBase& fractal, const WaveDomain& domain) {
  const double hurst = fractal.hurst_exponent;
  const double constant =
      std::exp2(2 * hurst + 1) * square(std::tgamma(1 + hurst)) * std::sin(std::numbers::pi * hurst);
  const double deviation_m =
      fractal.rms_deviation_m * std::pow(domain.spacing_m / fractal.reference_length_m, hurst);
  return deviation_m * std::sqrt(constant / static_cast<double>(domain.nx * domain.ny));
}

double lawful_deviation_m(const FractalBase& fractal, double lag_m) {
  return fractal.rms_deviation_m * std::pow(lag_m / fractal.reference_length_m, fractal.hurst_exponent);
}

double calibration_lag(const WaveDomain& domain, const FractalBase& fractal) {
  const double longest = std::max(4.0, static_cast<double>(std::min(domain.nx, domain.ny)) / 20);
  return std::clamp(fractal.reference_length_m / domain.spacing_m, 4.0, longest);
}

FractalWaves::FractalWaves(const WaveDomain& domain, const WaveBand& band, double hurst_exponent,
                           std::int64_t rows)
    : domain_(domain),
      hurst_(hurst_exponent),
      least_k2_(square(2 * std::numbers::pi * domain.spacing_m / band.below_m)),
      end_k2_(square(2 * std::numbers::pi * domain.spacing_m / band.from_m)),
      rows_(rows),
      columns_(static_cast<std::size_t>(domain.nx / 2 + 1)) {}

double FractalWaves::wave_x(std::size_t i) const {
  return 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(domain_.nx);
}

double FractalWaves::wave_y(std::int64_t j) const {
  return 2 * std::numbers::pi * static_cast<double>(j <= domain_.ny / 2 ? j : j - domain_.ny) /
         static_cast<double>(domain_.ny);
}

double FractalWaves::power(double k2) const {
  // The band is half-open, [from_m, below_m): the longest wavelength is excluded, the shortest included.
  return k2 > least_k2_ && k2 <= end_k2_ ? std::pow(k2, -(hurst_ + 1)) : 0;
}

std::vector<double> FractalWaves::column_powers(std::size_t i) const {
  const std::int64_t ny = domain_.ny;
  const double kx = wave_x(i);
  std::vector<double> powers(static_cast<std::size_t>(ny));
  for (std::int64_t j = 0; j <= ny / 2; ++j) {
    const double ky = wave_y(j);
    const double value = power(kx * kx + ky * ky);
    powers[static_cast<std::size_t>(j)] = value;
    if (j > 0) powers[static_cast<std::size_t>(ny - j)] = value;
  }
  return powers;
}

double FractalWaves::squared_deviation(double lag_nodes) const {
  std::vector<double> weight_y;
  for (std::int64_t j = 0; j < domain_.ny; ++j) weight_y.push_back(1 - std::cos(wave_y(j) * lag_nodes));
  std::vector<double> of_column(columns_);
  parallel_for(columns_, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double weight_x = 1 - std::cos(wave_x(i) * lag_nodes);
      const double mirrors = own_mirror(i) ? 1 : 2;
      const std::vector<double> powers = column_powers(i);
      for (std::size_t j = 0; j < powers.size(); ++j)
        of_column[i] += mirrors * powers[j] * (weight_x + weight_y[j]);
    }
  });
  double sum = 0;
  for (const double column : of_column) sum += column;
  return sum;
}

void FractalWaves::draw(const FractalDraw& draw, const ProgressCallback& progress) {
  partial_.resize(columns_ * static_cast<std::size_t>(rows_));
  parallel_for(
      columns_, 16, [&](std::size_t begin, std::size_t end) { draw_columns(begin, end, draw); }, progress);
}

void FractalWaves::draw_column(std::size_t i, const RandomField& random, std::uint64_t layer,
                               std::vector<Complex>& column) const {
  const std::vector<double> powers = column_powers(i);
  std::vector<double> real(powers.size());
  std::vector<double> imaginary(powers.size());
  random.normals_along_i(static_cast<std::uint64_t>(i) << 32U, 2 * layer, real);
  random.normals_along_i(static_cast<std::uint64_t>(i) << 32U, 2 * layer + 1, imaginary);
  // The transform along x drops the imaginary part of a column that is its own mirror image, and with it
  // half its power.
  const double gain = own_mirror(i) ? 1 : std::numbers::sqrt2 / 2;
  for (std::size_t j = 0; j < powers.size(); ++j)
    column[j] = gain * std::sqrt(powers[j]) * Complex(real[j], imaginary[j]);
}

void FractalWaves::draw_columns(std::size_t begin, std::size_t end, const FractalDraw& draw) {
  const RandomField random(draw.seed, RandomStream::fractal);
  Eigen::FFT<double> fft(Eigen::default_fft_impl<double>(), Eigen::FFT<double>::Unscaled);
  std::vector<Complex> waves(static_cast<std::size_t>(domain_.ny));
  std::vector<Complex> transformed(waves.size());
  for (std::size_t i = begin; i < end; ++i) {
    draw_column(i, random, draw.layer, waves);
    fft.inv(transformed.data(), waves.data(), static_cast<Eigen::Index>(domain_.ny));
    std::copy_n(transformed.begin(), rows_, partial_.begin() + static_cast<std::ptrdiff_t>(i) * rows_);
  }
}

void FractalWaves::add_to(Grid<double>& z, double factor, const ProgressCallback& progress) const {
  // Eight rows at a time, because a column stores neighbouring rows in one cache line.
  parallel_for(
      static_cast<std::size_t>(rows_), 8,
      [&](std::size_t begin, std::size_t end) { add_rows(z, factor, begin, end); }, progress);
}

void FractalWaves::add_rows(Grid<double>& z, double factor, std::size_t begin, std::size_t end) const {
  Eigen::FFT<double> fft(
      Eigen::default_fft_impl<double>(),
      Eigen::FFT<double>::Flag(Eigen::FFT<double>::Unscaled | Eigen::FFT<double>::HalfSpectrum));
  std::array<std::vector<Complex>, 8> waves;
  waves.fill(std::vector<Complex>(columns_));
  for (std::size_t i = 0; i < columns_; ++i)
    for (std::size_t r = begin; r < end; ++r) {
      const Complex wave = partial_[i * static_cast<std::size_t>(rows_) + r];
      waves[r - begin][i] = own_mirror(i) ? Complex(wave.real()) : wave;
    }
  std::vector<double> field(static_cast<std::size_t>(domain_.nx));
  for (std::size_t r = begin; r < end; ++r) {
    fft.inv(field.data(), waves[r - begin].data(), static_cast<Eigen::Index>(domain_.nx));
    const auto out = z.row(static_cast<std::int64_t>(r));
    for (std::size_t c = 0; c < out.size(); ++c) out[c] += factor * field[c];
  }
}

}  // namespace landfall
