// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "chain/lidar/receiver/echo.h"
#include "chain/lidar/receiver/echo_timing.h"
#include "chain/lidar/receiver/link_budget.h"
#include "chain/lidar/receiver/range_timer.h"
#include "targets.h"

namespace landfall {
namespace {

using Ray = std::pair<double, double>;
using std::numbers::pi;

std::size_t add(EchoRays& rays, std::vector<Ray> pixel, double gap_m) {
  std::vector<double> ranges;
  std::vector<double> signals;
  for (const auto& [range, signal] : pixel) {
    ranges.push_back(range);
    signals.push_back(signal);
  }
  return rays.add_pixel(ranges, signals, gap_m);
}

std::vector<Ray> rays_of(const EchoRays& rays, std::size_t echo) {
  std::vector<Ray> found;
  for (std::size_t j = 0; j < rays.rays_per_echo(); ++j)
    if (rays.signals_pe()[rays.index(echo, j)] > 0)
      found.emplace_back(rays.ranges_m()[rays.index(echo, j)], rays.signals_pe()[rays.index(echo, j)]);
  return found;
}

TEST(EchoRays, KeepsTheOrderWithinAShortEcho) {
  EchoRays rays;
  rays.clear(3);
  EXPECT_EQ(add(rays, {{10.1, 1}, {10, 2}, {10.05, 3}}, 0.15), 1U);
  EXPECT_EQ(rays_of(rays, 0), (std::vector<Ray>{{10.1, 1}, {10, 2}, {10.05, 3}}));
}

TEST(EchoRays, SplitsWhereNeighboursAreFarApart) {
  EchoRays rays;
  rays.clear(5);
  EXPECT_EQ(add(rays, {{12, 1}, {10, 2}, {10.1, 3}, {10.2, 4}, {11, 5}}, 0.15), 3U);
  EXPECT_EQ(rays_of(rays, 0), (std::vector<Ray>{{10, 2}, {10.1, 3}, {10.2, 4}}));
  EXPECT_EQ(rays_of(rays, 1), (std::vector<Ray>{{11, 5}}));
  EXPECT_EQ(rays_of(rays, 2), (std::vector<Ray>{{12, 1}}));
  EXPECT_EQ(rays.size(), 3U);
}

TEST(EchoRays, LeavesOutMissesAndRaysWithoutSignal) {
  EchoRays rays;
  rays.clear(4);
  EXPECT_EQ(add(rays, {{std::nan(""), 1}, {10, 0}, {10, std::nan("")}, {11, 2}}, 0.15), 1U);
  EXPECT_EQ(rays_of(rays, 0), (std::vector<Ray>{{11, 2}}));
  EXPECT_EQ(add(rays, {{std::nan(""), 1}, {10, 0}}, 0.15), 0U);
  EXPECT_EQ(rays.size(), 1U);
}

TEST(EchoRays, HoldsMoreEchoesThanABlock) {
  EchoRays rays;
  rays.clear(2);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(add(rays, {{100.0 + i, 1.0 + i}, {100.0 + i, 2.0}}, 0.1), 1U);
  for (std::size_t i = 0; i < 20; ++i) {
    const double value = static_cast<double>(i);
    EXPECT_EQ(rays_of(rays, i), (std::vector<Ray>{{100 + value, 1 + value}, {100 + value, 2}}));
  }
  rays.clear(1);
  EXPECT_EQ(rays.size(), 0U);
}

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
    on_every_target([&] { EXPECT_EQ(timed(pixels, timing), expected); });
  }
}

Direction<LidarFrame> towards(double x_rad, double y_rad) {
  return Direction<LidarFrame>::of({{std::tan(x_rad), std::tan(y_rad), 1}});
}

TEST(Illumination, WithoutADivergenceItIsUniform) {
  const Illumination beam;
  EXPECT_EQ(beam.relative(towards(0.3, -0.7)), 1);
  EXPECT_FALSE(beam.peak_per_sr());
}

TEST(Illumination, GaussianFallsTo1OverESquareAtHalfTheDivergence) {
  const Illumination beam({BeamProfile::gaussian, 2e-3, 0.01, -0.02});
  EXPECT_NEAR(beam.relative(towards(0.01, -0.02)), 1, 1e-15);
  EXPECT_NEAR(beam.relative(towards(0.011, -0.02)), std::exp(-2),
              2e-4);  // across the offset the angle is a little less
  const Illumination centred({BeamProfile::gaussian, 2e-3});
  EXPECT_NEAR(centred.relative(towards(0, 1e-3)), std::exp(-2), 1e-12);
  EXPECT_NEAR(centred.relative(towards(5e-4, 0)), std::exp(-0.5), 1e-12);
}

TEST(Illumination, TopHatEndsAtHalfTheDivergence) {
  const Illumination beam({BeamProfile::top_hat, 2e-3});
  EXPECT_EQ(beam.relative(towards(0.99e-3, 0)), 1);
  EXPECT_EQ(beam.relative(towards(1.01e-3, 0)), 0);
}

TEST(Illumination, TheWholeSolidAngleHoldsTheWholePulse) {
  constexpr double kDivergence = 2e-3;
  for (const BeamProfile profile : {BeamProfile::gaussian, BeamProfile::top_hat}) {
    const Illumination beam({profile, kDivergence});
    double energy = 0;
    constexpr double kStep = 1e-6;
    for (double theta = kStep / 2; theta < 4 * kDivergence; theta += kStep)
      energy += 2 * pi * theta * kStep * beam.relative(towards(theta, 0)) * *beam.peak_per_sr();
    EXPECT_NEAR(energy, 1, 1e-3);
  }
}

TEST(Illumination, NamesABadParameter) {
  for (const double bad : {0.0, -1e-3, 3.2, std::nan("")})
    EXPECT_THROW(Illumination({BeamProfile::gaussian, bad}), UsageError) << bad;
  EXPECT_THROW(Illumination({BeamProfile::gaussian, 1e-3, 1.6}), UsageError);
  EXPECT_THROW(Illumination({BeamProfile::gaussian, 1e-3, 0, -1.6}), UsageError);
}

TEST(LinkBudget, ReferenceSignalHoldsAtItsRange) {
  EXPECT_DOUBLE_EQ(link_constant_pe_m2(ReferenceSignal{400, 500}) / (500.0 * 500), 400);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2(ReferenceSignal{0, 500})), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2(ReferenceSignal{1, -1})), UsageError);
}

TEST(LinkBudget, DesignFollowsTheLidarEquation) {
  // by hand: 1 uJ at 1064 nm is 5.35628e12 photons; a pixel of (1e-4 rad)^2 in the middle of a Gaussian beam
  // of 2 mrad takes 8/(pi 4e-6) 1e-8 = 6.3662e-3 of them; a white Lambertian target at 500 m sends (pi
  // 0.025^2)/(pi 500^2) = 2.5e-9 of these into a telescope of 5 cm, of which 30 % are detected
  const LinkDesign design{1e-6, 1064e-9, 0.05, 0.3};
  const double constant = link_constant_pe_m2(design, 1e-8, Illumination({BeamProfile::gaussian, 2e-3}));
  EXPECT_NEAR(constant / (500.0 * 500), 5.35628e12 * 6.3662e-3 * 2.5e-9 * 0.3, 0.001);
}

TEST(LinkBudget, DesignNeedsADivergenceAndPositiveNumbers) {
  const Illumination beam({BeamProfile::top_hat, 2e-3});
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0.1, 0.5}, 1e-8, Illumination())),
               UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({0, 1e-6, 0.1, 0.5}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 0, 0.1, 0.5}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0, 0.5}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0.1, 1.1}, 1e-8, beam)), UsageError);
  EXPECT_THROW(static_cast<void>(link_constant_pe_m2({1e-6, 1e-6, 0.1, 0}, 1e-8, beam)), UsageError);
}

constexpr double kTimerHalfLight_mps = 149896229;

std::vector<double> timed(const RangeTimerParameters& parameters, std::size_t pixels, std::int64_t pulse = 0,
                          double range_m = 500, std::int64_t number = 0) {
  std::vector<double> ranges(pixels, range_m);
  RangeTimer(parameters, pixels, 7).apply(pulse, number, ranges);
  return ranges;
}

double standard_deviation(const std::vector<double>& values, double mean) {
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(RangeTimer, IsOffByDefault) {
  EXPECT_FALSE(RangeTimer().is_on());
  EXPECT_EQ(timed({}, 3), (std::vector<double>{500, 500, 500}));
}

TEST(RangeTimer, RoundsToTheNearestStep) {
  const double step_m = kTimerHalfLight_mps * 0.5e-9;
  for (const double steps : {100.0, 6671.4, 6671.6, 12.5001})
    EXPECT_NEAR(timed({.timer_step_s = 0.5e-9}, 1, 0, steps * step_m)[0], std::round(steps) * step_m, 1e-9)
        << steps;
}

TEST(RangeTimer, AFastClockCountsMore) { EXPECT_NEAR(timed({.clock_scale_ppm = 20}, 1)[0], 500.01, 1e-12); }

TEST(RangeTimer, EveryPixelKeepsItsOffset) {
  const RangeTimerParameters offsets{.pixel_offset_sigma_m = 0.02};
  const std::vector<double> first = timed(offsets, 20000, 0);
  EXPECT_EQ(timed(offsets, 20000, 17), first);
  EXPECT_EQ(timed(offsets, 20000, 17, 500, 2), first);
  EXPECT_NEAR(standard_deviation(first, 500), 0.02, 0.0005);
}

TEST(RangeTimer, EveryPixelHasTheOffsetThatIsGiven) {
  EXPECT_EQ(timed({.pixel_offset_m = {0.25, 0, -0.5}}, 3), (std::vector<double>{500.25, 500, 499.5}));
}

TEST(RangeTimer, JitterIsWhite) {
  const RangeTimerParameters jitter{.jitter_sigma_s = 1e-10};
  const std::vector<double> first = timed(jitter, 20000, 0);
  EXPECT_NEAR(standard_deviation(first, 500), kTimerHalfLight_mps * 1e-10, 4e-4);
  EXPECT_NE(timed(jitter, 20000, 1)[0], first[0]);
  EXPECT_NE(timed(jitter, 20000, 0, 500, 1)[0], first[0]);
}

TEST(RangeTimer, OneTermDoesNotChangeTheDrawsOfAnother) {
  const std::vector<double> jitter = timed({.jitter_sigma_s = 1e-10}, 10);
  const std::vector<double> offset = timed({.pixel_offset_sigma_m = 0.02}, 10);
  const std::vector<double> both = timed({.jitter_sigma_s = 1e-10, .pixel_offset_sigma_m = 0.02}, 10);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_NEAR(both[i], jitter[i] + offset[i] - 500, 1e-12);
}

TEST(RangeTimer, KeepsAMiss) {
  EXPECT_TRUE(std::isnan(timed({1e-10, 0.01, {}, 5, 1e-9}, 1, 0, std::nan(""))[0]));
}

TEST(RangeTimer, NamesABadParameter) {
  EXPECT_THROW(RangeTimer({.jitter_sigma_s = -1}, 1, 1), UsageError);
  EXPECT_THROW(RangeTimer({.pixel_offset_sigma_m = -1}, 1, 1), UsageError);
  EXPECT_THROW(RangeTimer({.clock_scale_ppm = 2e5}, 1, 1), UsageError);
  EXPECT_THROW(RangeTimer({.timer_step_s = std::nan("")}, 1, 1), UsageError);
}

}  // namespace
}  // namespace landfall
