// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/fractal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"

namespace landfall {
namespace {

using Complex = std::complex<double>;

/// Small primes only, for the FFT's sake; a multiple of 4 so that the real transform takes its fast way.
std::int64_t next_fft_size(std::int64_t least) {
  for (std::int64_t size = (least + 3) / 4 * 4;; size += 4) {
    std::int64_t rest = size;
    for (const std::int64_t prime : {2, 3, 5})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return size;
  }
}

/// A field on a periodic domain, synthesised wave by wave. Lengths are in nodes. The half-spectrum has one
/// column per wave number along x, 0..nx/2; only the rows of the grid are kept of each column's transform.
class Synthesis {
 public:
  Synthesis(const GridSpec& grid, const FractalBase& fractal, const FractalDraw& draw)
      : grid_(grid),
        nx_(next_fft_size(2 * grid.cols)),
        ny_(next_fft_size(2 * grid.rows)),
        hurst_(fractal.hurst_exponent),
        random_(draw.seed, RandomStream::fractal),
        layer_(draw.layer),
        columns_(static_cast<std::size_t>(nx_ / 2 + 1)),
        lag_nodes_(calibration_lag(fractal.reference_length_m / grid.resolution_m)),
        partial_(columns_ * static_cast<std::size_t>(grid.rows)),
        column_deviation_(columns_) {
    for (std::int64_t j = 0; j < ny_; ++j) lag_weight_y_.push_back(1 - std::cos(wave_y(j) * lag_nodes_));
  }

  /// Draws the waves and transforms along y.
  void make_columns(const ProgressCallback& progress) {
    parallel_for(
        columns_, 16, [&](std::size_t begin, std::size_t end) { make_columns(begin, end); }, progress);
  }

  /// Transforms along x and adds the field, times `factor`.
  void add_rows(Grid<double>& z, double factor, const ProgressCallback& progress) const {
    // Eight rows at a time, since a column keeps neighbouring rows in one cache line.
    parallel_for(
        static_cast<std::size_t>(grid_.rows), 8,
        [&](std::size_t begin, std::size_t end) { add_rows(z, factor, begin, end); }, progress);
  }

  /// The expected rms difference at the calibration lag before any scaling.
  [[nodiscard]] double deviation() const {
    double sum = 0;
    for (const double column : column_deviation_) sum += column;
    return std::sqrt(sum);
  }
  [[nodiscard]] double lag_nodes() const { return lag_nodes_; }

 private:
  [[nodiscard]] double calibration_lag(double reference_nodes) const {
    const double longest = std::max(4.0, static_cast<double>(std::min(nx_, ny_)) / 20);
    return std::clamp(reference_nodes, 4.0, longest);
  }
  [[nodiscard]] double wave_x(std::size_t i) const {
    return 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(nx_);
  }
  [[nodiscard]] double wave_y(std::int64_t j) const {
    return 2 * std::numbers::pi * static_cast<double>(j <= ny_ / 2 ? j : j - ny_) / static_cast<double>(ny_);
  }
  /// Columns 0 and nx/2 are their own mirror images; each other one stands for two.
  [[nodiscard]] bool own_mirror(std::size_t i) const { return i == 0 || i + 1 == columns_; }

  [[nodiscard]] Complex noise(std::size_t i, std::int64_t j) const {
    const std::uint64_t wave = static_cast<std::uint64_t>(i) << 32U | static_cast<std::uint64_t>(j);
    return {random_.normal(wave, 2 * layer_), random_.normal(wave, 2 * layer_ + 1)};
  }

  /// Fills the column of wave number i and returns its share of the structure function at the lag.
  double draw_column(std::size_t i, std::vector<Complex>& column) const {
    const double kx = wave_x(i);
    const double lag_weight_x = 1 - std::cos(kx * lag_nodes_);
    const double mirrors = own_mirror(i) ? 1 : 2;
    // The transform along x drops the imaginary part of a column that is its own mirror image, and with it
    // half its power.
    const double gain = own_mirror(i) ? 1 : std::numbers::sqrt2 / 2;
    double sum = 0;
    for (std::int64_t j = 0; j < ny_; ++j) {
      const double ky = wave_y(j);
      const double k2 = kx * kx + ky * ky;
      const double power = k2 > 0 ? std::pow(k2, -(hurst_ + 1)) : 0;
      const auto at = static_cast<std::size_t>(j);
      column[at] = gain * std::sqrt(power) * noise(i, j);
      sum += mirrors * power * (lag_weight_x + lag_weight_y_[at]);
    }
    return sum;
  }

  void make_columns(std::size_t begin, std::size_t end) {
    Eigen::FFT<double> fft(Eigen::default_fft_impl<double>(), Eigen::FFT<double>::Unscaled);
    std::vector<Complex> waves(static_cast<std::size_t>(ny_));
    std::vector<Complex> transformed(waves.size());
    const auto rows = static_cast<std::ptrdiff_t>(grid_.rows);
    for (std::size_t i = begin; i < end; ++i) {
      column_deviation_[i] = draw_column(i, waves);
      fft.inv(transformed.data(), waves.data(), static_cast<Eigen::Index>(ny_));
      std::copy_n(transformed.begin(), rows, partial_.begin() + static_cast<std::ptrdiff_t>(i) * rows);
    }
  }

  void add_rows(Grid<double>& z, double factor, std::size_t begin, std::size_t end) const {
    Eigen::FFT<double> fft(
        Eigen::default_fft_impl<double>(),
        Eigen::FFT<double>::Flag(Eigen::FFT<double>::Unscaled | Eigen::FFT<double>::HalfSpectrum));
    std::array<std::vector<Complex>, 8> waves;
    waves.fill(std::vector<Complex>(columns_));
    const auto rows = static_cast<std::size_t>(grid_.rows);
    for (std::size_t i = 0; i < columns_; ++i)
      for (std::size_t r = begin; r < end; ++r) {
        const Complex wave = partial_[i * rows + r];
        waves[r - begin][i] = own_mirror(i) ? Complex(wave.real()) : wave;
      }
    std::vector<double> field(static_cast<std::size_t>(nx_));
    for (std::size_t r = begin; r < end; ++r) {
      fft.inv(field.data(), waves[r - begin].data(), static_cast<Eigen::Index>(nx_));
      const auto out = z.row(static_cast<std::int64_t>(r));
      for (std::size_t c = 0; c < out.size(); ++c) out[c] += factor * field[c];
    }
  }

  GridSpec grid_;
  std::int64_t nx_;
  std::int64_t ny_;
  double hurst_;
  RandomField random_;
  std::uint64_t layer_;
  std::size_t columns_;
  double lag_nodes_;
  std::vector<Complex> partial_;
  std::vector<double> column_deviation_;
  std::vector<double> lag_weight_y_;
};

}  // namespace

void add_fractal(Grid<double>& z, const FractalBase& fractal, const FractalDraw& draw,
                 const ProgressCallback& progress) {
  Synthesis synthesis(z.spec(), fractal, draw);
  synthesis.make_columns([&](double fraction) { report(progress, fraction / 2); });
  const double lag_m = synthesis.lag_nodes() * z.spec().resolution_m;
  const double wanted_m =
      fractal.rms_deviation_m * std::pow(lag_m / fractal.reference_length_m, fractal.hurst_exponent);
  synthesis.add_rows(z, wanted_m / synthesis.deviation(),
                     [&](double fraction) { report(progress, 0.5 + fraction / 2); });
}

}  // namespace landfall
