// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/receiver/echo_timing.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <random>
#include <vector>

namespace landfall {
namespace {

constexpr double kPulseSigma_m = 0.0637;

struct Rays {
  std::vector<double> ranges_m, signals_pe;
};

std::vector<Echo> timed(const std::vector<Rays>& pixels, const EchoTiming& timing) {
  EchoRays rays;
  std::size_t maximum = 0;
  for (const Rays& pixel : pixels) maximum = std::max(maximum, pixel.ranges_m.size());
  rays.clear(maximum);
  for (Rays pixel : pixels) static_cast<void>(rays.add_pixel(pixel.ranges_m, pixel.signals_pe, 1e9));
  std::vector<Echo> echoes(rays.size());
  time_echoes(rays, timing, echoes);
  return echoes;
}

Echo timed(const Rays& pixel, const EchoTiming& timing) { return timed(std::vector{pixel}, timing).front(); }

/// w(r), the slow obvious way.
long double waveform(const Rays& rays, long double range_m) {
  long double sum = 0;
  for (std::size_t j = 0; j < rays.ranges_m.size(); ++j) {
    const long double x =
        (range_m - static_cast<long double>(rays.ranges_m[j])) / static_cast<long double>(kPulseSigma_m);
    sum += static_cast<long double>(rays.signals_pe[j]) * std::exp(-x * x / 2);
  }
  return sum;
}

/// The maximum and the first crossing of a level, by samples and bisection.
struct Searched {
  explicit Searched(const Rays& rays) : rays_(rays) {
    const auto [low, high] = std::minmax_element(rays.ranges_m.begin(), rays.ranges_m.end());
    begin_ = *low - 8 * kPulseSigma_m;
    for (long double at = begin_; at < *high + kPulseSigma_m; at += kStep)
      if (waveform(rays, at) > waveform(rays, peak_m)) peak_m = at;
    long double left = peak_m - kStep;
    long double right = peak_m + kStep;
    for (int i = 0; i < 100; ++i) {  // golden section would be faster
      const long double a = left + (right - left) / 3;
      const long double b = right - (right - left) / 3;
      (waveform(rays, a) < waveform(rays, b) ? left : right) = waveform(rays, a) < waveform(rays, b) ? a : b;
    }
    peak_m = (left + right) / 2;
  }

  [[nodiscard]] long double crossing_m(long double level) const {
    long double at = begin_;
    while (waveform(rays_, at) < level) at += kStep;
    long double low = at - kStep;
    for (int i = 0; i < 80; ++i) {
      const long double middle = (low + at) / 2;
      (waveform(rays_, middle) < level ? low : at) = middle;
    }
    return at;
  }

  long double peak_m = 0;

 private:
  static constexpr long double kStep = 2e-4L;
  const Rays& rays_;
  long double begin_ = 0;
};

Rays random_rays(std::mt19937_64& random, double length_m) {
  std::uniform_real_distribution<double> uniform;
  Rays rays;
  const double begin = 490 + 20 * uniform(random);
  for (int j = 0; j < 25; ++j) {
    rays.ranges_m.push_back(begin + length_m * uniform(random));
    rays.signals_pe.push_back(0.1 + 30 * uniform(random));
  }
  return rays;
}

TEST(EchoTiming, AnEchoOfOneRayHasThePulsesShape) {
  const Rays one{{500.125}, {80}};
  const Echo edge = timed(one, {TimingPoint::leading_edge, kPulseSigma_m, 20});
  EXPECT_DOUBLE_EQ(edge.signal_pe, 80);
  EXPECT_DOUBLE_EQ(edge.peak, 1);
  EXPECT_NEAR(edge.edge_m, kPulseSigma_m, 1e-12);
  EXPECT_NEAR(edge.width_m, kPulseSigma_m, 1e-12);
  EXPECT_NEAR(edge.range_m, 500.125, 1e-12);
  EXPECT_NEAR(timed(one, {TimingPoint::peak, kPulseSigma_m}).range_m, 500.125, 1e-12);
  EXPECT_NEAR(timed(one, {TimingPoint::centroid, kPulseSigma_m}).range_m, 500.125, 1e-12);
  const Echo fraction = timed(one, {TimingPoint::constant_fraction, kPulseSigma_m, 0, 0.3});
  EXPECT_NEAR(fraction.range_m, 500.125 - kPulseSigma_m * std::sqrt(2 * std::log(1 / 0.3)), 1e-10);
}

TEST(EchoTiming, BelowTheThresholdTheEdgeIsThatOfTheMaximum) {
  const Echo echo = timed({{500.125}, {10}}, {TimingPoint::leading_edge, kPulseSigma_m, 20});
  EXPECT_NEAR(echo.range_m, 500.125, 1e-12);
  EXPECT_NEAR(echo.edge_m, kPulseSigma_m, 1e-12);
}

TEST(EchoTiming, SumsAndMomentsAreThoseOfTheRays) {
  const Rays rays{{500, 500.2, 500.1}, {10, 30, 20}};
  const double mean = (500 * 10 + 500.2 * 30 + 500.1 * 20) / 60;
  const double variance =
      (10 * std::pow(500 - mean, 2) + 30 * std::pow(500.2 - mean, 2) + 20 * std::pow(500.1 - mean, 2)) / 60;
  const Echo echo = timed(rays, {TimingPoint::centroid, kPulseSigma_m});
  EXPECT_DOUBLE_EQ(echo.signal_pe, 60);
  EXPECT_NEAR(echo.range_m, mean, 1e-10);
  EXPECT_NEAR(echo.width_m, std::sqrt(kPulseSigma_m * kPulseSigma_m + variance), 1e-11);
}

TEST(EchoTiming, AgreesWithASearchOnShortAndLongEchoes) {
  std::mt19937_64 random(11);
  for (const double length_m : {0.001, 0.03, 0.06, 0.065, 0.15, 0.4, 1.5})
    for (int i = 0; i < 8; ++i) {
      const Rays rays = random_rays(random, length_m);
      const Searched searched(rays);
      const auto height = static_cast<double>(waveform(rays, searched.peak_m));
      const Echo peak = timed(rays, {TimingPoint::peak, kPulseSigma_m});
      EXPECT_NEAR(peak.range_m, static_cast<double>(searched.peak_m), 1e-7) << length_m;
      EXPECT_NEAR(peak.peak * peak.signal_pe, height, 1e-5 * height);
      for (const double fraction : {0.1, 0.5, 0.9}) {
        const Echo crossed = timed(rays, {TimingPoint::constant_fraction, kPulseSigma_m, 0, fraction});
        EXPECT_NEAR(crossed.range_m, static_cast<double>(searched.crossing_m(fraction * height)), 1e-9)
            << length_m << ' ' << fraction;
        const Echo edge = timed(rays, {TimingPoint::leading_edge, kPulseSigma_m, fraction * height});
        EXPECT_NEAR(edge.range_m - edge.edge_m * std::sqrt(2 * std::log(1 / fraction)),
                    static_cast<double>(searched.crossing_m(fraction * height)), 1e-9)
            << length_m << ' ' << fraction;
      }
    }
}

/// The waveform of a tilted plane is a box of length L convolved with the pulse:
/// w(r) = (N/2L) (erf((r - a)/sigma sqrt 2) - erf((r - a - L)/sigma sqrt 2)) sigma sqrt(2 pi)
TEST(EchoTiming, ConvergesToTheErrorFunctionsOnATiltedPlane) {
  constexpr double kLength_m = 0.1;
  const auto plane = [](int rays) {
    Rays pixel;
    for (int j = 0; j < rays; ++j) {
      pixel.ranges_m.push_back(500 + kLength_m * (j + 0.5) / rays);
      pixel.signals_pe.push_back(100.0 / rays);
    }
    return pixel;
  };
  const auto exact = [](double r) {
    const double root = kPulseSigma_m * std::sqrt(2.0);
    return std::erf((r - 500) / root) - std::erf((r - 500 - kLength_m) / root);
  };
  double low = 499;
  double high = 500 + kLength_m / 2;
  const double level = 0.5 * exact(high);
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2;
    (exact(middle) < level ? low : high) = middle;
  }
  const EchoTiming timing{TimingPoint::constant_fraction, kPulseSigma_m, 0, 0.5};
  const double error5 = std::abs(timed(plane(5), timing).range_m - low);
  const double error15 = std::abs(timed(plane(15), timing).range_m - low);
  EXPECT_LT(error5, 3e-4);
  EXPECT_LT(error15, error5 / 8);  // the midpoint rule: the error falls with the square
  EXPECT_NEAR(timed(plane(15), timing).width_m,
              std::sqrt(kPulseSigma_m * kPulseSigma_m + kLength_m * kLength_m / 12), 1e-4);
}

TEST(EchoTiming, NeitherTheNeighboursNorTheInstructionSetMatter) {
  std::mt19937_64 random(5);
  std::vector<Rays> pixels;
  for (int i = 0; i < 21; ++i) pixels.push_back(random_rays(random, i % 3 == 0 ? 0.3 : 0.05));
  for (const TimingPoint point : {TimingPoint::leading_edge, TimingPoint::constant_fraction,
                                  TimingPoint::peak, TimingPoint::centroid}) {
    const EchoTiming timing{point, kPulseSigma_m, 30, 0.5};
    const std::vector<Echo> expected = timed(pixels, timing);
    for (std::size_t i = 0; i < pixels.size(); ++i) EXPECT_EQ(timed(pixels[i], timing), expected[i]);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      EXPECT_EQ(timed(pixels, timing), expected) << hwy::TargetName(target);
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

}  // namespace
}  // namespace landfall
