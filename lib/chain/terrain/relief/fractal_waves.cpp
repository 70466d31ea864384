// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/fractal_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <unsupported/Eigen/FFT>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

/// The draws of the long waves: columns have fewer than 2^31.
constexpr std::uint64_t kLongWaves = std::uint64_t{1} << 63U;

/// exp(2 pi i k / n), 0 <= k, from the nearest quarter turn.
std::complex<double> unit_root(std::int64_t k, std::int64_t n) {
  const std::int64_t quarter = (8 * k + n) / (2 * n);
  const double angle =
      std::numbers::pi / 2 * (static_cast<double>(4 * k - quarter * n) / static_cast<double>(n));
  const double c = portable::cos(angle);
  const double s = portable::sin(angle);
  constexpr std::array<std::array<int, 4>, 4> kTurns = {
      {{1, 0, 0, 1}, {0, -1, 1, 0}, {-1, 0, 0, -1}, {0, 1, -1, 0}}};
  const auto& [cc, cs, sc, ss] = kTurns.at(static_cast<std::size_t>(quarter % 4));
  return {cc * c + cs * s, sc * c + ss * s};
}

/// Eigen's transform, given the factors of its inverse transforms before it would take those of the C
/// library, which differ in the last bit between processors.
class PortableFft : public Eigen::internal::kissfft_impl<double> {
 public:
  PortableFft() = default;
  /// `nodes` is a multiple of 4.
  explicit PortableFft(std::int64_t nodes) {
    for (const std::int64_t size : {nodes, nodes / 2}) add_plan(size);
    std::vector<Complex>& halves = m_realTwiddles[static_cast<int>(nodes / 4)];
    for (std::int64_t k = 1; k <= nodes / 4; ++k)
      halves.push_back(std::conj(unit_root(4 * k + nodes, 4 * nodes)));
  }

 private:
  void add_plan(std::int64_t size) {
    auto& plan = m_plans[PlanKey(static_cast<int>(size), true)];
    plan.m_inverse = true;
    plan.factorize(static_cast<int>(size));
    for (std::int64_t k = 0; k < size; ++k) plan.m_twiddles.push_back(unit_root(k, size));
  }
};

using Fft = Eigen::FFT<double, PortableFft>;

}  // namespace

FractalWaves::FractalWaves(const FractalSpectrum& spectrum, std::int64_t rows)
    : spectrum_(spectrum), rows_(rows), columns_(static_cast<std::size_t>(spectrum.domain().nodes / 2 + 1)) {}

void FractalWaves::draw(const FractalDraw& draw, const ProgressCallback& progress) {
  partial_.resize(columns_ * static_cast<std::size_t>(rows_));
  parallel_for(
      columns_, 16, [&](std::size_t begin, std::size_t end) { draw_columns(begin, end, draw); }, progress);
  draw_long_waves(draw);
}

void FractalWaves::draw_long_waves(const FractalDraw& draw) {
  const RandomField random(draw.seed, RandomStream::fractal);
  const auto waves = spectrum_.long_waves();
  long_waves_.clear();
  for (std::size_t n = 0; n < waves.size(); ++n) {
    const double deviation = std::sqrt(2 * waves[n].power);  // with its opposite
    long_waves_.push_back({waves[n].kx, waves[n].ky,
                           deviation * random.normal(kLongWaves + n, 2 * draw.layer),
                           deviation * random.normal(kLongWaves + n, 2 * draw.layer + 1)});
  }
  const double slope = std::sqrt(spectrum_.slope_power());
  slope_x_ = slope * random.normal(kLongWaves + waves.size(), 2 * draw.layer);
  slope_y_ = slope * random.normal(kLongWaves + waves.size(), 2 * draw.layer + 1);
}

void FractalWaves::draw_column(std::size_t i, const RandomField& random, std::uint64_t layer,
                               std::vector<Complex>& column) const {
  const std::int64_t half = nodes() / 2;
  std::vector<double> powers(static_cast<std::size_t>(nodes()));
  for (std::int64_t j = 0; j <= half; ++j) {
    const double power = spectrum_.power(static_cast<std::int64_t>(i), j);
    powers[static_cast<std::size_t>(j)] = power;
    if (j > 0) powers[static_cast<std::size_t>(nodes() - j)] = power;
  }
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
  Fft fft(PortableFft(nodes()), Fft::Unscaled);
  std::vector<Complex> waves(static_cast<std::size_t>(nodes()));
  std::vector<Complex> transformed(waves.size());
  for (std::size_t i = begin; i < end; ++i) {
    draw_column(i, random, draw.layer, waves);
    fft.inv(transformed.data(), waves.data(), static_cast<Eigen::Index>(nodes()));
    std::copy_n(transformed.begin(), rows_, partial_.begin() + static_cast<std::ptrdiff_t>(i) * rows_);
  }
}

/// The long waves and the plane row by row, as a sum over the distinct kx.
class FractalWaves::LongRows {
 public:
  LongRows(const FractalWaves& waves, const GridSpec& grid) : waves_(waves), grid_(grid) {
    for (const DrawnWave& wave : waves.long_waves_) {
      if (kx_.empty() || kx_.back() != wave.kx) kx_.push_back(wave.kx);
      middle_ += wave.cosine;
    }
    for (const double kx : kx_)
      for (std::int64_t col = 0; col < grid.cols; ++col) {
        cosines_.push_back(portable::cos(kx * x(col)));
        sines_.push_back(portable::sin(kx * x(col)));
      }
  }

  void add_to(std::span<double> out, std::int64_t row, double factor) const {
    const double y = static_cast<double>(row) - static_cast<double>(grid_.rows - 1) / 2;
    for (std::size_t col = 0; col < out.size(); ++col)
      out[col] +=
          factor * (waves_.slope_x_ * x(static_cast<std::int64_t>(col)) + waves_.slope_y_ * y - middle_);
    auto wave = waves_.long_waves_.begin();
    for (std::size_t n = 0; n < kx_.size(); ++n) {
      double cosine = 0;
      double sine = 0;
      for (; wave != waves_.long_waves_.end() && wave->kx == kx_[n]; ++wave) {
        const double c = portable::cos(wave->ky * y);
        const double s = portable::sin(wave->ky * y);
        cosine += factor * (wave->cosine * c + wave->sine * s);
        sine += factor * (wave->sine * c - wave->cosine * s);
      }
      const double* const cosines = &cosines_[n * out.size()];
      const double* const sines = &sines_[n * out.size()];
      for (std::size_t col = 0; col < out.size(); ++col)
        out[col] += cosine * cosines[col] + sine * sines[col];
    }
  }

 private:
  [[nodiscard]] double x(std::int64_t col) const {
    return static_cast<double>(col) - static_cast<double>(grid_.cols - 1) / 2;
  }

  const FractalWaves& waves_;
  GridSpec grid_;
  std::vector<double> kx_;
  std::vector<double> cosines_;  ///< of kx x, by [kx][column]
  std::vector<double> sines_;
  double middle_ = 0;
};

void FractalWaves::add_to(Grid<double>& z, double factor, const ProgressCallback& progress) const {
  // Eight rows at a time, because a column stores neighbouring rows in one cache line.
  const LongRows long_rows(*this, z.spec());
  parallel_for(
      static_cast<std::size_t>(rows_), 8,
      [&](std::size_t begin, std::size_t end) {
        add_rows(z, factor, begin, end);
        for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
          long_rows.add_to(z.row(row), row, factor);
      },
      progress);
}

void FractalWaves::add_rows(Grid<double>& z, double factor, std::size_t begin, std::size_t end) const {
  Fft fft(PortableFft(nodes()), Fft::Flag(Fft::Unscaled | Fft::HalfSpectrum));
  std::array<std::vector<Complex>, 8> waves;
  waves.fill(std::vector<Complex>(columns_));
  for (std::size_t i = 0; i < columns_; ++i)
    for (std::size_t r = begin; r < end; ++r) {
      const Complex wave = partial_[i * static_cast<std::size_t>(rows_) + r];
      waves[r - begin][i] = own_mirror(i) ? Complex(wave.real()) : wave;
    }
  std::vector<double> field(static_cast<std::size_t>(nodes()));
  for (std::size_t r = begin; r < end; ++r) {
    fft.inv(field.data(), waves[r - begin].data(), static_cast<Eigen::Index>(nodes()));
    const auto out = z.row(static_cast<std::int64_t>(r));
    for (std::size_t c = 0; c < out.size(); ++c) out[c] += factor * field[c];
  }
}

}  // namespace landfall
