// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/receiver/receiver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "base/core/error.h"

namespace landfall {
namespace {

constexpr double kHalfLight_mps = 149896229;
constexpr double kFwhm_s = 1e-9;
const double kSigma_m = kHalfLight_mps * kFwhm_s / (2 * std::sqrt(2 * std::numbers::ln2));

struct Pixel {
  std::vector<double> ranges_m, signals_pe;
};

Waveforms seen(const Receiver& receiver, std::size_t pixels, const Pixel& pixel) {
  Waveforms waveforms;
  waveforms.clear(pixel.ranges_m.size());
  for (std::size_t i = 0; i < pixels; ++i) {
    Pixel copy = pixel;
    receiver.add_pixel(copy.ranges_m, copy.signals_pe, waveforms);
  }
  receiver.time(waveforms);
  return waveforms;
}

/// The reports of `count` equal pixels in one pulse.
std::vector<Detection> received(const ReceiverParameters& parameters, const Pixel& pixel,
                                std::size_t count = 1, std::uint64_t seed = 3) {
  const Receiver receiver(parameters, seed);
  const Waveforms waveforms = seen(receiver, count, pixel);
  std::vector<Detection> detections(count * receiver.max_returns());
  if (receiver.accepts_kept_echoes()) {
    std::vector<Echo> kept(count);
    std::vector<LaterEcho> later;
    receiver.keep_echoes(0, waveforms, kept, later);
    receiver.receive(0, kept, later, detections);
  } else {
    receiver.receive(0, waveforms, detections);
  }
  return detections;
}

ReceiverParameters quiet(ReceiverType type) { return {.type = type, .photon_noise = false}; }

struct Moments {
  double share = 0, mean = 0, deviation = 0;
};

Moments of_ranges(const std::vector<Detection>& detections) {
  double n = 0;
  double sum = 0;
  double squares = 0;
  for (const Detection& detection : detections) {
    if (std::isnan(detection.range_m)) continue;
    ++n;
    sum += detection.range_m - 500;
    squares += (detection.range_m - 500) * (detection.range_m - 500);
  }
  const double mean = sum / n;
  return {n / static_cast<double>(detections.size()), mean, std::sqrt(squares / n - mean * mean)};
}

TEST(Receiver, AFixedThresholdWalksWithTheSignal) {
  for (const double signal : {20.0, 25.0, 100.0, 4000.0}) {
    const double range = received(quiet(ReceiverType::leading_edge), {{500}, {signal}})[0].range_m;
    EXPECT_NEAR(range - 500, -kSigma_m * std::sqrt(2 * std::log(signal / 20)), 1e-10) << signal;
  }
}

/// The edge of a flat or double maximum must not reach far before the nearest sub-ray, however close its
/// height is to the threshold.
TEST(Receiver, ALeadingEdgeStaysNearItsEcho) {
  for (const double apart : {1.5, 2.0, 2.3})
    for (const double above : {0.8, 0.99, 1.0001, 1.001, 1.01, 1.1, 1.5, 3.0}) {
      const double top = apart <= 2 ? 2 * std::exp(-apart * apart / 8) : 1 + std::exp(-apart * apart / 2);
      const double each = above * 20 / top;
      const Pixel pixel{{500, 500 + apart * kSigma_m}, {each, 1.00001 * each}};
      for (const Detection& detection : received({.type = ReceiverType::leading_edge}, pixel, 4000))
        EXPECT_FALSE(detection.range_m < 500 - 5 * kSigma_m)
            << apart << ' ' << above << ' ' << detection.range_m;
    }
}

TEST(Receiver, WalkCorrectionMakesUnstretchedEchoesExact) {
  ReceiverParameters corrected = quiet(ReceiverType::leading_edge);
  corrected.walk_correction = true;
  for (const double signal : {21.0, 100.0, 4000.0})
    EXPECT_NEAR(received(corrected, {{500}, {signal}})[0].range_m, 500, 1e-10) << signal;
  // A stretched echo keeps the difference of its edge and the pulse's.
  const double stretched = received(corrected, {{500, 500.1}, {200, 200}})[0].range_m;
  EXPECT_GT(std::abs(stretched - 500.05), 0.003);
}

TEST(Receiver, TheOtherTypesDoNotWalk) {
  for (const ReceiverType type :
       {ReceiverType::constant_fraction, ReceiverType::peak, ReceiverType::centroid})
    for (const double signal : {20.0, 100.0, 4000.0})
      EXPECT_NEAR(received(quiet(type), {{500}, {signal}})[0].range_m, 500, 1e-10);
}

TEST(Receiver, AWeakOrStretchedEchoIsNotDetected) {
  EXPECT_TRUE(std::isnan(received(quiet(ReceiverType::peak), {{500}, {19.9}})[0].range_m));
  EXPECT_FALSE(std::isnan(received(quiet(ReceiverType::peak), {{500}, {20.1}})[0].range_m));
  EXPECT_TRUE(std::isnan(received(quiet(ReceiverType::peak), {{500, 500.14}, {10.5, 10.5}})[0].range_m));
  EXPECT_TRUE(std::isnan(received(quiet(ReceiverType::peak), {{std::nan("")}, {100}})[0].range_m));
}

TEST(Receiver, TheIntensityIsTheNumberOfPhotoelectrons) {
  EXPECT_FLOAT_EQ(received(quiet(ReceiverType::centroid), {{500, 500.01}, {30, 40}})[0].intensity_pe, 70);
  EXPECT_TRUE(std::isnan(received(quiet(ReceiverType::centroid), {{500}, {3}})[0].intensity_pe));
  double sum = 0;
  for (const Detection& detection :
       received({.type = ReceiverType::peak, .threshold_pe = 1}, {{500}, {60}}, 20000))
    sum += static_cast<double>(detection.intensity_pe);
  EXPECT_NEAR(sum / 20000, 60, 4 * std::sqrt(60.0 / 20000));
}

TEST(Receiver, DetectionFollowsThePoissonDistribution) {
  for (const double mean : {4.0, 12.0, 25.0, 60.0}) {
    double below = 0;  // P(n < 20)
    for (int n = 0; n < 20; ++n) below += std::exp(n * std::log(mean) - mean - std::lgamma(n + 1.0));
    const double share =
        of_ranges(received({.type = ReceiverType::peak, .threshold_pe = 20}, {{500}, {mean}}, 40000)).share;
    EXPECT_NEAR(share, 1 - below, 4 * std::sqrt(below * (1 - below) / 40000) + 1e-4) << mean;
  }
}

TEST(Receiver, TheTimeOfNPhotoelectronsScattersByTheWidthOverTheRootOfN) {
  const Moments moments = of_ranges(received({.type = ReceiverType::centroid}, {{500}, {400}}, 40000));
  EXPECT_NEAR(moments.mean, 0, 4 * kSigma_m / 20 / 200);
  EXPECT_NEAR(moments.deviation, kSigma_m / 20, 0.02 * kSigma_m / 20);
}

TEST(Receiver, BackgroundAddsNoiseButNoSignal) {
  ReceiverParameters bright{.type = ReceiverType::centroid, .threshold_pe = 1};
  bright.gate_end_m = 100;
  bright.background_pe = 300 * 100 / (kHalfLight_mps * kFwhm_s);  // 300 within one FWHM
  const std::vector<Detection> detections = received(bright, {{500}, {100}}, 40000);
  double sum = 0;
  double squares = 0;
  for (const Detection& detection : detections) {
    sum += static_cast<double>(detection.intensity_pe) - 100;
    squares += std::pow(static_cast<double>(detection.intensity_pe) - 100, 2);
  }
  EXPECT_NEAR(sum / 40000, 0, 4 * 20.0 / 200);
  EXPECT_NEAR(std::sqrt(squares / 40000), 20, 0.4);
}

/// The Cramer-Rao bound of the time of n g(x) + b/FWHM, g a Gaussian of the standard deviation `width` and x
/// in units of the pulse's: the Fisher information is the integral of (n g')^2/(n g + b/FWHM).
double cramer_rao(double n, double b, double width) {
  const double fwhm = 2 * std::sqrt(2 * std::numbers::ln2);
  double information = 0;
  constexpr double kStep = 1e-3;
  for (double x = -12 * width; x < 12 * width; x += kStep) {
    const double shape = std::exp(-x * x / (2 * width * width)) / (width * std::sqrt(2 * std::numbers::pi));
    const double slope = -x / (width * width) * n * shape;
    information += kStep * slope * slope / (n * shape + b / fwhm);
  }
  return 1 / std::sqrt(information);
}

TEST(Receiver, TimesAreAsGoodAsTheCramerRaoBoundWithAnyBackground) {
  constexpr double kSignal = 10000;  // its scatter changes the error by 0.5 %
  for (const double background : {0.0, 100.0, 1000.0, 10000.0, 1e6}) {
    ReceiverParameters bright{.type = ReceiverType::centroid, .threshold_pe = 1};
    bright.gate_end_m = 100;
    bright.background_pe = background * bright.gate_end_m / (kHalfLight_mps * kFwhm_s);
    for (const double apart : {0.0, 2.0}) {
      const Pixel pixel{{500 - apart * kSigma_m / 2, 500 + apart * kSigma_m / 2}, {kSignal / 2, kSignal / 2}};
      const double bound = kSigma_m * cramer_rao(kSignal, background, std::sqrt(1 + apart * apart / 4));
      const double deviation = of_ranges(received(bright, pixel, 20000)).deviation;
      EXPECT_GT(deviation, 0.9 * bound) << background << ' ' << apart;
      EXPECT_LT(deviation, 1.02 * bound) << background << ' ' << apart;
    }
  }
}

/// Whatever the photoelectrons of the echoes before it: here each is near the threshold.
TEST(Receiver, TheFirstReturnIsTheFirstRowOfAll) {
  const Pixel weak{{500, 503, 506, 509}, {17, 23, 12, 40}};
  for (const ReceiverType type : {ReceiverType::leading_edge, ReceiverType::constant_fraction,
                                  ReceiverType::peak, ReceiverType::centroid}) {
    ReceiverParameters parameters{.type = type, .background_pe = 100};
    const std::vector<Detection> first = received(parameters, weak, 500);
    parameters.returns = ReportedReturns::all;
    const std::vector<Detection> all = received(parameters, weak, 500);
    const std::size_t maximum = all.size() / first.size();
    std::vector<std::size_t> from_echo(4);
    for (std::size_t i = 0; i < first.size(); ++i) {
      ASSERT_FALSE(std::isnan(first[i].range_m)) << i;
      EXPECT_EQ(first[i].range_m, all[maximum * i].range_m) << i;
      EXPECT_EQ(first[i].intensity_pe, all[maximum * i].intensity_pe) << i;
      ++from_echo.at(static_cast<std::size_t>(std::lround((first[i].range_m - 500) / 3)));
    }
    for (const std::size_t count : from_echo) EXPECT_GT(count, 0U);
  }
}

TEST(Receiver, ReportsTheFirstTheLastOrTheStrongestDetectableEcho) {
  const Pixel edge{{500, 500.01, 503, 506, 509}, {30, 30, 15, 80, 40}};
  ReceiverParameters parameters = quiet(ReceiverType::centroid);
  EXPECT_NEAR(received(parameters, edge)[0].range_m, 500.005, 1e-10);
  parameters.returns = ReportedReturns::last;
  EXPECT_NEAR(received(parameters, edge)[0].range_m, 509, 1e-10);
  parameters.returns = ReportedReturns::strongest;
  EXPECT_NEAR(received(parameters, edge)[0].range_m, 506, 1e-10);
  parameters.returns = ReportedReturns::all;
  const std::vector<Detection> all = received(parameters, edge);
  ASSERT_EQ(all.size(), 5U);
  EXPECT_NEAR(all[0].range_m, 500.005, 1e-10);
  EXPECT_NEAR(all[1].range_m, 506, 1e-10);  // 15 photoelectrons at 503 m are not detected
  EXPECT_NEAR(all[2].range_m, 509, 1e-10);
  EXPECT_TRUE(std::isnan(all[3].range_m));
  parameters.max_returns = 2;
  EXPECT_EQ(received(parameters, edge).size(), 2U);
}

TEST(Receiver, EchoesMergeWithinAFullWidth) {
  ReceiverParameters parameters = quiet(ReceiverType::centroid);
  parameters.returns = ReportedReturns::all;
  const double fwhm_m = kHalfLight_mps * kFwhm_s;
  EXPECT_TRUE(std::isnan(received(parameters, {{500, 500 + 0.99 * fwhm_m}, {50, 50}})[1].range_m));
  EXPECT_NEAR(received(parameters, {{500, 500 + 1.01 * fwhm_m}, {50, 50}})[1].range_m, 500 + 1.01 * fwhm_m,
              1e-10);
}

/// The mean of the first of a Poisson process of mean N and Gaussian shape, given that there is one:
/// integral of r N g(r) exp(-N Phi(r)) dr / (1 - exp(-N)).
double first_photon_mean(double mean) {
  double sum = 0;
  constexpr double kStep = 1e-3;
  for (double x = -9; x < 9; x += kStep) {
    const double shape = std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
    const double below = 0.5 * std::erfc(-x / std::numbers::sqrt2);
    sum += kStep * x * mean * shape * std::exp(-mean * below);
  }
  return sum / (1 - std::exp(-mean));
}

TEST(Receiver, GeigerTimesTheFirstPhotoelectron) {
  for (const double mean : {0.2, 1.0, 4.0, 10.0, 200.0}) {
    const Moments moments = of_ranges(received({.type = ReceiverType::geiger}, {{500}, {mean}}, 60000));
    const double detected = 1 - std::exp(-mean);
    EXPECT_NEAR(moments.share, detected, 4 * std::sqrt(detected * (1 - detected) / 60000) + 1e-12) << mean;
    EXPECT_NEAR(moments.mean, kSigma_m * first_photon_mean(mean),
                4 * moments.deviation / std::sqrt(60000 * detected))
        << mean;
  }
}

TEST(Receiver, GeigerDependsOnTheWholeSignalNotOnItsSubRays) {
  const Moments split = of_ranges(received(
      {.type = ReceiverType::geiger}, {std::vector<double>(25, 500.0), std::vector<double>(25, 0.2)}, 60000));
  EXPECT_NEAR(split.share, 1 - std::exp(-5), 0.002);
  EXPECT_NEAR(split.mean, kSigma_m * first_photon_mean(5), 4 * split.deviation / std::sqrt(60000));
}

TEST(Receiver, AGeigerPixelIsBlindAfterAPhotoelectron) {
  ReceiverParameters parameters{
      .type = ReceiverType::geiger, .returns = ReportedReturns::all, .max_returns = 3};
  const Pixel edge{{500, 501, 504}, {100, 100, 100}};
  std::vector<Detection> all = received(parameters, edge);
  EXPECT_NEAR(all[0].range_m, 500, 0.4);
  EXPECT_NEAR(all[1].range_m, 501, 0.4);
  EXPECT_NEAR(all[2].range_m, 504, 0.4);
  parameters.dead_time_s = 15e-9;  // 2.25 m
  all = received(parameters, edge);
  EXPECT_NEAR(all[1].range_m, 504, 0.4);
  EXPECT_TRUE(std::isnan(all[2].range_m));
  parameters.returns = ReportedReturns::last;
  EXPECT_NEAR(received(parameters, edge)[0].range_m, 504, 0.4);
}

TEST(Receiver, TheFirstPhotoelectronMayBelongToTheSecondEcho) {
  const double gap_m = 1.01 * kHalfLight_mps * kFwhm_s;
  const Pixel edge{{500, 500 + gap_m},
                   {0.5, 1e6}};  // the strong echo's first lies 4.9 sigma before its centre
  ReceiverParameters parameters{.type = ReceiverType::geiger};
  for (const Detection& detection : received(parameters, edge, 2000))
    EXPECT_LT(detection.range_m, 500 + gap_m - 4 * kSigma_m);
  parameters.returns = ReportedReturns::all;
  parameters.max_returns = 2;
  const std::vector<Detection> both = received(parameters, edge, 2000);
  for (std::size_t i = 0; i < both.size(); i += 2) EXPECT_FALSE(both[i].range_m > both[i + 1].range_m) << i;
}

TEST(Receiver, TheGateLimitsTheBackgroundOnly) {
  const ReceiverParameters parameters{.type = ReceiverType::geiger, .gate_begin_m = 100, .gate_end_m = 200};
  for (const double range_m : {50.0, 150.0, 250.0})
    EXPECT_NEAR(received(parameters, {{range_m}, {1000}})[0].range_m, range_m, 0.5);
}

TEST(Receiver, BackgroundMayComeFirst) {
  ReceiverParameters parameters{
      .type = ReceiverType::geiger, .background_pe = 0.5, .gate_begin_m = 300, .gate_end_m = 700};
  const std::vector<Detection> detections = received(parameters, {{500}, {1000}}, 40000);
  double background = 0;
  for (const Detection& detection : detections) {
    background += detection.is_background ? 1 : 0;
    if (detection.is_background) {
      EXPECT_GE(detection.range_m, 300);
      EXPECT_LT(detection.range_m, 500);
    }
  }
  const double expected = 1 - std::exp(-0.25);  // half of the gate lies before the echo
  EXPECT_NEAR(background / 40000, expected, 4 * std::sqrt(expected * (1 - expected) / 40000) + 1e-4);
  EXPECT_EQ(of_ranges(received(parameters, {{std::nan("")}, {1}}, 40000)).share, [&] {
    double n = 0;
    for (const Detection& detection : received(parameters, {{std::nan("")}, {1}}, 40000))
      n += detection.is_background ? 1 : 0;
    return n / 40000;
  }());
}

TEST(Receiver, DrawsDependOnPulsePixelAndSeedOnly) {
  const ReceiverParameters parameters{.type = ReceiverType::leading_edge};
  const std::vector<Detection> many = received(parameters, {{500}, {60}}, 600);
  const std::vector<Detection> few = received(parameters, {{500}, {60}}, 300);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].range_m, many[i].range_m);
  EXPECT_NE(received(parameters, {{500}, {60}}, 1, 4)[0].range_m, many[0].range_m);
  ReceiverParameters all = parameters;  // the same draws of the first echo
  all.returns = ReportedReturns::all;
  all.max_returns = 1;
  EXPECT_EQ(received(all, {{500}, {60}}, 5)[4].range_m, many[4].range_m);
}

TEST(Receiver, NamesABadParameter) {
  const auto refuses = [](const std::function<void(ReceiverParameters&)>& change) {
    ReceiverParameters parameters{.type = ReceiverType::peak};
    change(parameters);
    EXPECT_THROW(Receiver(parameters, 1), UsageError);
  };
  refuses([](auto& p) { p.pulse_fwhm_s = 0; });
  refuses([](auto& p) { p.threshold_pe = 0; });
  refuses([](auto& p) { p.fraction = 1; });
  refuses([](auto& p) { p.dead_time_s = -1; });
  refuses([](auto& p) { p.background_pe = -1; });
  refuses([](auto& p) { p.max_returns = 6; });
  refuses([](auto& p) {
    p.type = ReceiverType::geiger;
    p.returns = ReportedReturns::strongest;
  });
}

}  // namespace
}  // namespace landfall
