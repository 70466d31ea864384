// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/fractal_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "band_law.h"

namespace landfall {
namespace {

constexpr std::int64_t kGridNodes = 120;  // nodes of the grid, half the domain

/// The expected squared difference of two nodes: the sum over all waves, metres^2.
double squared_difference(const FractalSpectrum& spectrum, double amplitude_m, double dx, double dy) {
  const std::int64_t half = spectrum.domain().nodes / 2;
  double sum = spectrum.slope_power() * (dx * dx + dy * dy);
  for (std::int64_t i = -half + 1; i <= half; ++i)
    for (std::int64_t j = -half + 1; j <= half; ++j)
      sum += 2 * spectrum.power(i, j) *
             (1 - std::cos(spectrum.wave_number(i) * dx + spectrum.wave_number(j) * dy));
  for (const LongWave& wave : spectrum.long_waves())
    sum += 2 * 2 * wave.power * (1 - std::cos(wave.kx * dx + wave.ky * dy));
  return sum * amplitude_m * amplitude_m;
}

struct SpectrumCase {
  double hurst;
  double longest_nodes;  ///< may be infinite
};

class Spectrum : public ::testing::TestWithParam<SpectrumCase> {};

// No random number: the expectation itself against the law, along an axis, a diagonal and between them.
TEST_P(Spectrum, SumsToTheLawAtAllScales) {
  constexpr double kSpacing_m = 0.5;
  const auto [hurst, longest_nodes] = GetParam();
  const FractalBase law{hurst, 0.3, 5};
  const WaveDomain domain = WaveDomain::around({kSpacing_m, 0, 0, kGridNodes, kGridNodes});
  ASSERT_EQ(domain.nodes, 2 * kGridNodes);
  const FractalSpectrum spectrum(domain, {0, longest_nodes * kSpacing_m}, hurst);
  const double whole = std::isinf(longest_nodes) ? 0.01 : 0.035;
  for (const double lag : {1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 60.0, 90.0, 120.0})
    for (const double turn : {0.0, 0.125, 0.07}) {
      const double angle = 2 * std::numbers::pi * turn;
      // At distances of a node or two, only whole nodes exist.
      const double dx = std::round(lag * std::cos(angle));
      const double dy = std::round(lag * std::sin(angle));
      const double length_m = std::hypot(dx, dy) * kSpacing_m;
      const double expected_m = std::isinf(longest_nodes)
                                    ? 0.3 * std::pow(length_m / 5, hurst)
                                    : band_deviation_m(law, longest_nodes * kSpacing_m, length_m);
      const double deviation_m = std::sqrt(squared_difference(spectrum, law_amplitude(law, domain), dx, dy));
      EXPECT_NEAR(deviation_m / expected_m, 1, lag <= kGridNodes / 5 ? 0.003 : whole) << dx << ' ' << dy;
    }
}

constexpr double kAll = std::numeric_limits<double>::infinity();
// The longer band of a large terrain, without waves shorter than 8 nodes: the law less the shorter band.
TEST(Spectrum, ALongBandIsWhatAShortOneLacks) {
  const FractalBase law{0.8, 0.3, 5};
  const WaveDomain domain{4, 2 * kGridNodes};
  const FractalSpectrum spectrum(domain, {32, kAll}, 0.8);
  for (const double lag : {4.0, 8.0, 24.0, 60.0, 120.0}) {
    const double short_m = band_deviation_m(law, 32, lag * 4);
    const double square_m2 = std::pow(0.3 * std::pow(lag * 4 / 5, 0.8), 2) - short_m * short_m;
    EXPECT_NEAR(std::sqrt(squared_difference(spectrum, law_amplitude(law, domain), lag, 0) / square_m2), 1,
                0.01)
        << lag;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, Spectrum,
                         ::testing::Values(SpectrumCase{0.05, kAll}, SpectrumCase{0.2, kAll},
                                           SpectrumCase{0.5, kAll}, SpectrumCase{0.8, kAll},
                                           SpectrumCase{0.95, kAll}, SpectrumCase{0.5, 4},
                                           SpectrumCase{0.8, 4}, SpectrumCase{0.8, 30},
                                           SpectrumCase{0.5, 120}, SpectrumCase{0.8, 120},
                                           SpectrumCase{0.8, 360}, SpectrumCase{0.8, 3600}));

TEST(Spectrum, WithoutWavesLongerThanTwoNodesIsEmpty) {
  for (const double longest_m : {1.0, 1.0 + 1e-7}) {
    const FractalSpectrum spectrum({0.5, 64}, {0, longest_m}, 0.7);
    for (std::int64_t i = 0; i <= 32; ++i)
      for (std::int64_t j = 0; j <= 32; ++j) ASSERT_EQ(spectrum.power(i, j), 0);
    EXPECT_TRUE(spectrum.long_waves().empty());
    EXPECT_EQ(spectrum.slope_power(), 0);
  }
  EXPECT_GT(FractalSpectrum({0.5, 64}, {0, 1.01}, 0.7).power(32, 32), 0);
}

}  // namespace
}  // namespace landfall
