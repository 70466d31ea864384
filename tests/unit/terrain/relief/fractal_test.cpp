// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/relief/fractal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "band_law.h"
#include "base/parallel.h"
#include "terrain/relief/fractal_waves.h"

namespace landfall {
namespace {

Grid<double> fractal(const GridSpec& spec, const FractalBase& parameters, const FractalDraw& draw) {
  Grid<double> z(spec);
  add_fractal(z, parameters, draw);
  return z;
}

/// Mean squared elevation difference at a lag, along both axes.
double squared_deviation(const Grid<double>& z, std::int64_t lag) {
  double sum = 0;
  std::int64_t count = 0;
  const GridSpec& spec = z.spec();
  for (std::int64_t r = 0; r < spec.rows; ++r)
    for (std::int64_t c = 0; c < spec.cols; ++c) {
      if (c + lag < spec.cols) sum += std::pow(z.at({r, c + lag}) - z.at({r, c}), 2), ++count;
      if (r + lag < spec.rows) sum += std::pow(z.at({r + lag, c}) - z.at({r, c}), 2), ++count;
    }
  return sum / static_cast<double>(count);
}

/// For each lag, rms over `seeds` realisations divided by the law.
std::vector<double> deviation_ratios(const FractalBase& parameters, const std::vector<std::int64_t>& lags,
                                     std::uint64_t seeds) {
  const GridSpec spec = GridSpec::centered(64, 0.5);  // 257 x 257
  std::vector<double> ratios(lags.size());
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Grid<double> z = fractal(spec, parameters, {seed, 0});
    for (std::size_t i = 0; i < lags.size(); ++i) ratios[i] += squared_deviation(z, lags[i]);
  }
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double length_m = static_cast<double>(lags[i]) * spec.resolution_m;
    ratios[i] = std::sqrt(ratios[i] / static_cast<double>(seeds)) /
                (parameters.rms_deviation_m *
                 std::pow(length_m / parameters.reference_length_m, parameters.hurst_exponent));
  }
  return ratios;
}

class StructureFunction : public ::testing::TestWithParam<double> {};

// nu(L) = nu_0 (L / L_0)^H from 4 nodes to a tenth of the grid (25 nodes). Measured over 60 realisations:
// within 0.8 % at L_0 and 5 % elsewhere (H = 0.8, 25 nodes: 0.950; 4 nodes: 1.043). The rest is for 24
// realisations.
TEST_P(StructureFunction, FollowsTheLaw) {
  const std::vector<std::int64_t> lags = {4, 6, 10, 16, 25};
  const auto ratios = deviation_ratios({GetParam(), 0.3, 5}, lags, 24);  // L_0 = 10 nodes
  for (std::size_t i = 0; i < lags.size(); ++i)
    EXPECT_NEAR(ratios[i], 1, lags[i] == 10 ? 0.03 : 0.07) << "lag " << lags[i];
}

INSTANTIATE_TEST_SUITE_P(Hurst, StructureFunction, ::testing::Values(0.5, 0.6, 0.7, 0.8));

TEST(BandOracle, WithoutACutIsTheLaw) {
  for (const double hurst : {0.5, 0.8})
    EXPECT_NEAR(band_deviation_m({hurst, 0.3, 5}, 1e12, 7), 0.3 * std::pow(7.0 / 5, hurst),
                1e-4);  // lacks 8e-5 beyond 1e12 m
}

// Waves shorter than 32 nodes keep the amplitude of the full law. Waves shorter than 2 nodes are missing:
// 4 nodes have less than the law, H = 0.5 most.
TEST_P(StructureFunction, OfABandFollowsTheLaw) {
  const GridSpec spec = GridSpec::centered(64, 0.5);
  const FractalBase law{GetParam(), 0.3, 5, 16};
  constexpr int kSeeds = 12;
  for (const std::int64_t lag : {6, 10, 16, 25, 40}) {
    double squares = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
      squares += squared_deviation(fractal(spec, law, {seed, 0}), lag) / kSeeds;
    const double expected_m = band_deviation_m(law, 16, static_cast<double>(lag) * spec.resolution_m);
    EXPECT_NEAR(std::sqrt(squares) / expected_m, 1, 0.05) << "lag " << lag;
  }
}

// The amplitude does not depend on the size of the grid, nor on what the reference length is to it.
TEST(Fractal, ABandHasTheFullLawsAmplitude) {
  const double near = deviation_ratios({0.7, 0.3, 5, 8}, {4}, 4)[0];
  const double far = deviation_ratios({0.7, 0.3 * std::pow(1000 / 5.0, 0.7), 1000, 8}, {4}, 4)[0];
  EXPECT_NEAR(far / near, 1, 1e-12);
}

/// The part of a periodic field that the wave (i, j) has.
double wave_amplitude(const Grid<double>& z, std::int64_t i, std::int64_t j) {
  std::complex<double> sum = 0;
  const GridSpec& spec = z.spec();
  for (std::int64_t r = 0; r < spec.rows; ++r)
    for (std::int64_t c = 0; c < spec.cols; ++c)
      sum +=
          z.at({r, c}) * std::polar(1.0, -2 * std::numbers::pi *
                                             (static_cast<double>(i * c) / static_cast<double>(spec.cols) +
                                              static_cast<double>(j * r) / static_cast<double>(spec.rows)));
  return std::abs(sum) / static_cast<double>(spec.size());
}

// 96 x 80 nodes of 0.5 m, waves in [6, 12) m: in cycles per metre hypot(i / 48, j / 40) in (1/12, 1/6].
TEST(FractalWaves, HaveNothingOutsideTheirBand) {
  const WaveDomain domain{0.5, 96, 80};
  FractalWaves waves(domain, {6, 12}, 0.7, 80);
  waves.draw({3, 1});
  Grid<double> z(GridSpec{0.5, 0, 0, 80, 96});
  waves.add_to(z, 1);
  for (std::int64_t i = 0; i < 14; ++i)
    for (std::int64_t j = -12; j < 12; ++j) {
      const double cycles_per_m = std::hypot(static_cast<double>(i) / 48, static_cast<double>(j) / 40);
      const bool in_band = cycles_per_m > 1.0 / 12 + 1e-9 && cycles_per_m < 1.0 / 6 - 1e-9;
      const bool out = cycles_per_m < 1.0 / 12 - 1e-9 || cycles_per_m > 1.0 / 6 + 1e-9;
      if (in_band) {
        EXPECT_GT(wave_amplitude(z, i, j), 1e-3) << i << ' ' << j;
      }
      if (out) {
        EXPECT_LT(wave_amplitude(z, i, j), 1e-12) << i << ' ' << j;
      }
    }
}

// The law is scaled, not cut off, where the domain cannot carry the reference length itself.
TEST(Fractal, ReferenceLengthBeyondTheGrid) {
  EXPECT_NEAR(deviation_ratios({0.7, 0.3 * std::pow(1000 / 5.0, 0.7), 1000}, {10}, 8)[0], 1, 0.08);
  EXPECT_NEAR(deviation_ratios({0.7, 0.3 * std::pow(0.1 / 5.0, 0.7), 0.1}, {10}, 8)[0], 1, 0.08);
}

bool same(const Grid<double>& a, const Grid<double>& b) { return std::ranges::equal(a.values(), b.values()); }

TEST(Fractal, SeedAndLayerChooseTheDraw) {
  const GridSpec spec = GridSpec::centered(8, 0.5);
  const Grid<double> z = fractal(spec, {}, {1, 0});
  EXPECT_TRUE(same(z, fractal(spec, {}, {1, 0})));
  EXPECT_FALSE(same(z, fractal(spec, {}, {2, 0})));
  EXPECT_FALSE(same(z, fractal(spec, {}, {1, 1})));
}

TEST(Fractal, LayersAreUncorrelated) {
  const GridSpec spec = GridSpec::centered(64, 0.5);
  const Grid<double> a = fractal(spec, {0.5, 1, 4}, {1, 0});
  const Grid<double> b = fractal(spec, {0.5, 1, 4}, {1, 1});
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (std::int64_t r = 0; r < spec.rows; ++r)
    for (std::int64_t c = 1; c < spec.cols; ++c) {  // differences, which hardly correlate in space
      const double da = a.at({r, c}) - a.at({r, c - 1});
      const double db = b.at({r, c}) - b.at({r, c - 1});
      ab += da * db;
      aa += da * da;
      bb += db * db;
    }
  EXPECT_LT(std::abs(ab) / std::sqrt(aa * bb), 0.02);  // 5 sigma of 65,792 independent pairs
}

TEST(Fractal, AnyThreadCountGivesTheSame) {
  const GridSpec spec = GridSpec::centered(40, 0.5);
  const Grid<double> all = fractal(spec, {}, {7, 3});
  const ThreadLimit one(1);
  EXPECT_TRUE(same(all, fractal(spec, {}, {7, 3})));
}

TEST(Fractal, AddsToWhatIsThere) {
  const GridSpec spec{0.5, 0, 0, 12, 30};  // not square
  Grid<double> z(spec, 100.0);
  add_fractal(z, {}, {1, 0});
  const Grid<double> alone = fractal(spec, {}, {1, 0});
  for (std::size_t i = 0; i < z.values().size(); ++i)
    EXPECT_NEAR(z.values()[i] - 100, alone.values()[i], 1e-12);
}

TEST(Fractal, ProgressRisesToOne) {
  Grid<double> z(GridSpec::centered(8, 0.5));
  std::vector<double> fractions;
  add_fractal(z, {}, {1, 0}, [&](double fraction) { fractions.push_back(fraction); });
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace landfall
