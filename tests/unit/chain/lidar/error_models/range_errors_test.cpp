// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/error_models/range_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/core/error.h"
#include "base/numerics/random.h"
#include "refusal.h"

namespace landfall {
namespace {

constexpr std::int64_t kNoisePulses = 1000;
constexpr std::int64_t kPixels = 324;
constexpr double kCount = static_cast<double>(kNoisePulses * kPixels);

double fraction_of(const auto& happens) {
  int count = 0;
  for (std::int64_t pulse = 0; pulse < kNoisePulses; ++pulse)
    for (std::int64_t pixel = 0; pixel < kPixels; ++pixel) count += happens(PulsePixel{pulse, pixel}) ? 1 : 0;
  return count / kCount;
}

bool is_dropped(const RangeErrors& errors, PulsePixel where) {
  std::vector<std::int8_t> all(static_cast<std::size_t>(where.pixel) + 1);
  errors.find_dropouts(where.pulse, all);
  return all.back() != 0;
}

TEST(RangeErrors, DefaultsAreNoErrorsAndAGateOfOneKilometre) {
  const RangeErrorParameters none;
  EXPECT_EQ(none.range_sigma_m, 0);
  EXPECT_EQ(none.false_min_m, 0);
  EXPECT_EQ(none.false_max_m, 1000);
  EXPECT_EQ(PulsePixel{}.pulse, 0);
  EXPECT_EQ(PulsePixel{}.pixel, 0);
}

TEST(RangeErrors, ChancesHoldUpToTheirOwnDraw) {
  const RandomField dead(3, RandomStream::dead_pixel);
  const RandomField dropout(3, RandomStream::dropout);
  const RandomField wrong(3, RandomStream::false_return);
  const RangeErrors errors({.dead_pixel_frac = dead.uniform(8),
                            .dropout_frac = dropout.uniform(2, 8),
                            .false_return_frac = wrong.uniform(2, 8)},
                           3);
  EXPECT_FALSE(errors.is_dead(8));
  EXPECT_FALSE(is_dropped(errors, {2, 8}));
  EXPECT_FALSE(errors.false_return_m({2, 8}));
  for (std::uint64_t i = 0; i < 20; ++i) {
    EXPECT_EQ(errors.is_dead(static_cast<std::int64_t>(i)), dead.uniform(i) < dead.uniform(8));
    EXPECT_EQ(is_dropped(errors, {2, static_cast<std::int64_t>(i)}),
              dropout.uniform(2, i) < dropout.uniform(2, 8));
  }
}

// The range comes from a second draw, 2^32 pixels on (docs/reference/draws.md).
TEST(RangeErrors, AFalseRangeIsItsSecondDraw) {
  const RangeErrors errors({.false_return_frac = 1, .false_min_m = 100, .false_max_m = 300}, 3);
  const RandomField wrong(3, RandomStream::false_return);
  EXPECT_EQ(errors.false_return_m({2, 8}), 100 + 200 * wrong.uniform(2, 8 + (std::uint64_t{1} << 32U)));
}

TEST(RangeErrors, NoneByDefault) {
  const RangeErrors errors({}, 1);
  EXPECT_FALSE(errors.has_false_returns());
  EXPECT_EQ(errors.measured_m(500.25, {3, 4}), 500.25);
  for (std::int64_t i = 0; i < 1000; ++i) {
    ASSERT_FALSE(errors.is_dead(i));
    ASSERT_FALSE(is_dropped(errors, {i, i}));
  }
}

TEST(RangeErrors, FractionOneIsEverything) {
  const RangeErrors errors({.dead_pixel_frac = 1, .dropout_frac = 1}, 1);
  for (std::int64_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(errors.is_dead(i));
    ASSERT_TRUE(is_dropped(errors, {i, i}));
  }
}

TEST(RangeErrors, BiasIsAdded) {
  EXPECT_EQ(RangeErrors({.range_bias_m = -0.5}, 1).measured_m(100, {0, 0}), 99.5);
}

TEST(RangeErrors, NoiseScalesWithSigma) {
  const RangeErrors one({.range_sigma_m = 1}, 7);
  const RangeErrors two({.range_sigma_m = 2, .range_bias_m = 10}, 7);
  const double v = one.measured_m(0, {5, 6});
  EXPECT_NE(v, 0);
  EXPECT_EQ(two.measured_m(0, {5, 6}), 10 + 2 * v);
}

// Tolerances of the statistical tests are 5 standard errors: a correct generator fails one seed in 1.7
// million. The seeds are fixed, so a failure is a change, not chance.
TEST(RangeErrors, NoiseHasItsSigma) {
  const RangeErrors errors({.range_sigma_m = 0.05 / 3}, 1);
  double sum = 0;
  double squares = 0;
  for (std::int64_t pulse = 0; pulse < kNoisePulses; ++pulse)
    for (std::int64_t pixel = 0; pixel < kPixels; ++pixel) {
      const double v = errors.measured_m(0, {pulse, pixel}) / (0.05 / 3);
      sum += v;
      squares += v * v;
    }
  EXPECT_NEAR(sum / kCount, 0, 5 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1, 5 * std::sqrt(2 / kCount));
}

TEST(RangeErrors, DropoutHasItsFraction) {
  const RangeErrors errors({.dropout_frac = 0.1}, 1);
  std::vector<std::int8_t> is_dropped(kPixels);
  std::int64_t count = 0;
  for (std::int64_t pulse = 0; pulse < kNoisePulses; ++pulse) {
    errors.find_dropouts(pulse, is_dropped);
    count += std::ranges::count(is_dropped, 1);
  }
  EXPECT_NEAR(static_cast<double>(count) / kCount, 0.1, 5 * std::sqrt(0.1 * 0.9 / kCount));
}

TEST(RangeErrors, DeadHasItsFraction) {
  const RangeErrors errors({.dead_pixel_frac = 0.02}, 1);
  constexpr int kMany = 100000;
  int dead = 0;
  for (std::int64_t i = 0; i < kMany; ++i) dead += errors.is_dead(i) ? 1 : 0;
  EXPECT_NEAR(dead / double{kMany}, 0.02, 5 * std::sqrt(0.02 * 0.98 / kMany));
}

// Were dropout and dead pixels drawn from one stream, the same pixels of pulse 0 would be both.
TEST(RangeErrors, StreamsAreApart) {
  const RangeErrors errors({.dead_pixel_frac = 0.5, .dropout_frac = 0.5}, 1);
  constexpr int kMany = 10000;
  int agree = 0;
  for (std::int64_t i = 0; i < kMany; ++i) agree += errors.is_dead(i) == is_dropped(errors, {i, 0}) ? 1 : 0;
  EXPECT_NEAR(agree / double{kMany}, 0.5, 5 * std::sqrt(0.25 / kMany));
}

TEST(RangeErrors, OneErrorChangesNoDrawOfAnother) {
  const RangeErrors alone({.range_sigma_m = 0.1}, 3);
  const RangeErrors together({.range_sigma_m = 0.1, .dead_pixel_frac = 0.3, .dropout_frac = 0.3}, 3);
  const RangeErrors dead_only({.dead_pixel_frac = 0.3}, 3);
  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(alone.measured_m(1, {i, 2}), together.measured_m(1, {i, 2}));
    EXPECT_EQ(dead_only.is_dead(i), together.is_dead(i));
  }
}

TEST(RangeErrors, WholePulsesAreMeasuredAsSinglePixels) {
  std::vector<double> ranges(kPixels);
  for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = 400 + 0.37 * static_cast<double>(i);
  ranges[7] = std::nan("");
  std::vector<double> measured(ranges.size());
  for (const double sigma_m : {0.0, 0.05}) {
    const RangeErrors errors({.range_sigma_m = sigma_m, .range_bias_m = 0.3}, 5);
    errors.measure(12, ranges, {}, measured);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      if (i == 7) continue;
      ASSERT_EQ(measured[i], errors.measured_m(ranges[i], {12, static_cast<std::int64_t>(i)})) << i;
    }
    EXPECT_TRUE(std::isnan(measured[7]));
  }
}

// sigma^2 = 0.03^2 + (1e-4 * 400)^2 + (2e-4 * 400 * tan)^2 with tan = 1.5: 0.03, 0.04 and 0.12 give 0.13.
TEST(RangeErrors, SigmaGrowsWithRangeAndIncidence) {
  const RangeErrors errors({.range_sigma_m = 0.03, .range_sigma_per_m = 1e-4, .incidence_sigma_rad = 2e-4},
                           1);
  EXPECT_TRUE(errors.needs_incidence());
  EXPECT_NEAR(errors.sigma_m(400, 1.5), 0.13, 1e-16);
  EXPECT_NEAR(errors.sigma_m(400, 0), 0.05, 1e-16);
  EXPECT_EQ(errors.sigma_m(0, 1.5), 0.03);
  const RangeErrors constant({.range_sigma_m = 0.03}, 1);
  EXPECT_FALSE(constant.needs_incidence());
  EXPECT_EQ(constant.sigma_m(400, 1.5), 0.03);
}

TEST(RangeErrors, EitherGrowthOfSigmaAloneCounts) {
  const RangeErrors by_range({.range_sigma_per_m = 1e-3}, 1);
  EXPECT_EQ(by_range.sigma_m(400, 1.5), 0.4);
  EXPECT_FALSE(by_range.needs_incidence());
  EXPECT_NE(by_range.measured_m(400, {0, 0}), 400);
  const RangeErrors by_incidence({.incidence_sigma_rad = 1e-3}, 1);
  EXPECT_DOUBLE_EQ(by_incidence.sigma_m(400, 1.5), 0.6);
  EXPECT_NE(by_incidence.measured_m(400, {0, 0}, 1.5), 400);
}

TEST(RangeErrors, GrowthOfOneIsGrowth) {
  EXPECT_EQ(RangeErrors({.range_sigma_per_m = 1}, 1).sigma_m(400, 0), 400);
  EXPECT_EQ(RangeErrors({.incidence_sigma_rad = 1}, 1).sigma_m(400, 1.5), 600);
}

TEST(RangeErrors, APixelWithoutAnIncidenceLooksStraightAtTheGround) {
  const RangeErrors errors({.range_sigma_m = 0.03, .incidence_sigma_rad = 1e-3}, 5);
  EXPECT_EQ(errors.measured_m(400, {12, 3}), errors.measured_m(400, {12, 3}, 0));
  EXPECT_NE(errors.measured_m(400, {12, 3}), errors.measured_m(400, {12, 3}, 1));
}

TEST(RangeErrors, BiasIsAddedToWholePulsesOfAnySigma) {
  const RangeErrors errors({.range_sigma_m = 0.1, .range_bias_m = 0.3, .range_sigma_per_m = 1e-3}, 5);
  const std::vector<double> ranges{400, 500};
  std::vector<double> measured(2);
  errors.measure(12, ranges, {}, measured);
  EXPECT_EQ(measured[0], errors.measured_m(400, {12, 0}));
  EXPECT_EQ(measured[1], errors.measured_m(500, {12, 1}));
}

// The same standard normal draw, whatever scales it; whole pulses as single pixels.
TEST(RangeErrors, OnlyTheScaleOfADrawChanges) {
  const RangeErrors unit({.range_sigma_m = 1}, 9);
  const RangeErrors errors({.range_sigma_per_m = 1e-3, .incidence_sigma_rad = 1e-3}, 9);
  std::vector<double> ranges(kPixels);
  std::vector<double> tangents(ranges.size());
  std::vector<double> measured(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    ranges[i] = 100 + static_cast<double>(i);
    tangents[i] = 0.01 * static_cast<double>(i);
  }
  errors.measure(3, ranges, tangents, measured);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const PulsePixel where{3, static_cast<std::int64_t>(i)};
    const double v = unit.measured_m(0, where);
    EXPECT_DOUBLE_EQ(measured[i], ranges[i] + 1e-3 * ranges[i] * std::hypot(1, tangents[i]) * v);
    EXPECT_EQ(measured[i], errors.measured_m(ranges[i], where, tangents[i]));
  }
}

TEST(RangeErrors, FalseReturnsHaveTheirFractionAndFillTheirGate) {
  const RangeErrors errors({.false_return_frac = 0.05, .false_min_m = 100, .false_max_m = 300}, 2);
  double sum = 0;
  double squares = 0;
  int count = 0;
  for (std::int64_t pulse = 0; pulse < kNoisePulses; ++pulse)
    for (std::int64_t pixel = 0; pixel < kPixels; ++pixel)
      if (const auto range = errors.false_return_m({pulse, pixel})) {
        ASSERT_GE(*range, 100);
        ASSERT_LT(*range, 300);
        sum += *range;
        squares += (*range - 200) * (*range - 200);
        ++count;
      }
  EXPECT_NEAR(count / kCount, 0.05, 5 * std::sqrt(0.05 * 0.95 / kCount));
  // Uniform over 200 m: variance 200^2 / 12; of squares about the middle (200^4) (1/80 - 1/144).
  EXPECT_NEAR(sum / count, 200, 5 * 200 / std::sqrt(12.0 * count));
  EXPECT_NEAR(squares / count, 200 * 200 / 12.0, 5 * 200 * 200 * std::sqrt((1 / 80.0 - 1 / 144.0) / count));
  EXPECT_FALSE(RangeErrors({}, 2).false_return_m({0, 0}));
}

TEST(RangeErrors, FalseReturnsHaveAStreamOfTheirOwn) {
  const RangeErrors alone({.false_return_frac = 0.5}, 2);
  const RangeErrors all(
      {.range_sigma_m = 1, .dead_pixel_frac = 0.5, .dropout_frac = 0.5, .false_return_frac = 0.5}, 2);
  int agree = 0;
  for (std::int64_t i = 0; i < 10000; ++i) {
    ASSERT_EQ(alone.false_return_m({i, 3}), all.false_return_m({i, 3}));
    agree += is_dropped(all, {i, 3}) == all.false_return_m({i, 3}).has_value() ? 1 : 0;
  }
  EXPECT_NEAR(agree / 1e4, 0.5, 5 * std::sqrt(0.25 / 1e4));
}

TEST(RangeErrors, SeedsDiffer) {
  const RangeErrorParameters noise{.range_sigma_m = 1};
  EXPECT_NE(RangeErrors(noise, 1).measured_m(0, {0, 0}), RangeErrors(noise, 2).measured_m(0, {0, 0}));
}

TEST(RangeErrors, RefusesWhatIsOutOfRange) {
  const double nan = std::nan("");
  const auto refused = [](RangeErrorParameters p) { EXPECT_THROW(RangeErrors(p, 1), UsageError); };
  refused({.range_sigma_m = -0.01});
  refused({.range_sigma_m = nan});
  refused({.range_sigma_m = HUGE_VAL});
  refused({.range_bias_m = nan});
  refused({.dead_pixel_frac = -0.1});
  refused({.dead_pixel_frac = 1.1});
  refused({.dropout_frac = -0.1});
  refused({.dropout_frac = nan});
  refused({.range_sigma_per_m = -1});
  refused({.incidence_sigma_rad = nan});
  refused({.false_return_frac = 1.1});
  refused({.false_min_m = -1});
  refused({.false_min_m = 5, .false_max_m = 5});
  refused({.false_max_m = HUGE_VAL});
  EXPECT_THAT(refusal([&] { const RangeErrors errors({.dropout_frac = 1.5}, 1); }),
              testing::HasSubstr("dropout_frac: 1.5 is not in [0, 1]"));
}

}  // namespace
}  // namespace landfall
