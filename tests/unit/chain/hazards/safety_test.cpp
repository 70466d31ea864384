// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/numerics/random.h"
#include "bins.h"
#include "chain/hazards/safety.h"
#include "chain/hazards/sigma_parts.h"
#include "constants.h"

namespace landfall {
namespace {

struct Place {
  double slope_deg, roughness_m;
};

PlaceMeasures places(const std::vector<Place>& list) {
  const GridSpec spec{1, 0, 0, 1, static_cast<std::int64_t>(list.size())};
  PlaceMeasures measures{Grid<double>(spec), Grid<double>(spec)};
  for (std::size_t i = 0; i < list.size(); ++i) {
    measures.slope_deg.values()[i] = list[i].slope_deg;
    measures.roughness_m.values()[i] = list[i].roughness_m;
  }
  return measures;
}

TEST(Safety, AValueAtItsLimitIsSafe) {
  const Grid<std::int8_t> safe =
      judge_places(places({{10, 0.3}, {std::nextafter(10, 11), 0}, {0, 0.31}, {0, -1}, {kNan, 0}}), {});
  EXPECT_EQ(std::vector<int>(safe.values().begin(), safe.values().end()), (std::vector<int>{1, 0, 0, 1, 2}));
}

TEST(Safety, OutcomesOfAllPairs) {
  Grid<std::int8_t> judged(GridSpec{1, 0, 0, 3, 3});
  Grid<std::int8_t> truth(GridSpec{1, 0, 0, 3, 3});
  for (std::size_t i = 0; i < 9; ++i) {
    judged.values()[i] = static_cast<std::int8_t>(i / 3);
    truth.values()[i] = static_cast<std::int8_t>(i % 3);
  }
  const Grid<std::int8_t> found = outcomes(judged, truth);
  EXPECT_EQ(std::vector<int>(found.values().begin(), found.values().end()),
            (std::vector<int>{0, 3, 4, 2, 1, 4, 4, 4, 4}));
}

TEST(HazardScore, CountsRatesAndCurves) {
  // judged: safe, safe, hazard by roughness, hazard by slope, unknown, safe; truth: safe, hazard, safe,
  // hazard, safe, unknown
  const PlaceMeasures judged = places({{0, 0.1}, {0, 0.2}, {0, 0.4}, {20, 0}, {kNan, kNan}, {0, 0}, {0, 0}});
  const PlaceMeasures truth = places({{0, 0}, {0, 1}, {0, 0}, {0, 1}, {0, 0}, {kNan, kNan}, {0, 1}});
  BinMask region(judged.slope_deg.spec(), 1);
  region.values()[6] = 0;
  const HazardScore score = score_hazards(judged, truth, {}, region, nullptr);
  EXPECT_EQ(score.counts.safe_safe, 1);
  EXPECT_EQ(score.counts.safe_hazard, 1);
  EXPECT_EQ(score.counts.hazard_safe, 1);
  EXPECT_EQ(score.counts.hazard_hazard, 1);
  EXPECT_EQ(score.counts.unknown, 2);
  EXPECT_DOUBLE_EQ(*score.rates.missed_hazard_frac, 0.5);
  EXPECT_DOUBLE_EQ(*score.rates.false_alarm_frac, 0.5);
  EXPECT_FALSE(score.brier);
  EXPECT_TRUE(score.reliability.empty());
  ASSERT_EQ(score.roc.size(), 21U);
  EXPECT_DOUBLE_EQ(score.roc[20].roughness_limit_m, 0.6);
  EXPECT_DOUBLE_EQ(*score.roc[0].rates.missed_hazard_frac, 0);  // all but roughness 0 judged hazards
  EXPECT_DOUBLE_EQ(*score.roc[0].rates.false_alarm_frac, 1);
  EXPECT_DOUBLE_EQ(*score.roc[20].rates.missed_hazard_frac, 0.5);  // only the slope is left
  EXPECT_DOUBLE_EQ(*score.roc[20].rates.false_alarm_frac, 0);
}

TEST(HazardScore, WithoutPlacesThereAreNoFractions) {
  const PlaceMeasures measures = places({{0, 0}});
  const HazardScore score =
      score_hazards(measures, measures, {}, BinMask(measures.slope_deg.spec()), nullptr);
  EXPECT_FALSE(score.rates.missed_hazard_frac);
  EXPECT_FALSE(score.rates.false_alarm_frac);
}

TEST(HazardScore, BrierAndReliability) {
  const PlaceMeasures judged = places({{0, 0}, {0, 0}, {0, 0}, {0, 0}});
  const PlaceMeasures truth = places({{0, 0}, {0, 1}, {0, 0}, {0, 0}});
  Grid<float> p(judged.slope_deg.spec());
  const std::array<float, 4> values{1.0F, 0.25F, 0.25F, std::numeric_limits<float>::quiet_NaN()};
  std::copy(values.begin(), values.end(), p.values().begin());
  const HazardScore score = score_hazards(judged, truth, {}, BinMask(p.spec(), 1), &p);
  EXPECT_DOUBLE_EQ(*score.brier, (0 + 0.0625 + 0.5625) / 3);
  ASSERT_EQ(score.reliability.size(), 10U);
  EXPECT_EQ(score.reliability[2].count, 2);
  EXPECT_DOUBLE_EQ(*score.reliability[2].safe_frac, 0.5);
  EXPECT_DOUBLE_EQ(*score.reliability[9].safe_frac, 1);
  EXPECT_DOUBLE_EQ(score.reliability[2].p_low, 0.2);
  EXPECT_DOUBLE_EQ(score.reliability[2].p_high, 0.3);
  EXPECT_EQ(score.reliability[9].count, 1);
  EXPECT_FALSE(score.reliability[0].safe_frac);
}

// The first place of the region is false on both counts: judged safe, and a hazard in truth.
TEST(HazardScore, OfOnePlace) {
  const PlaceMeasures judged = places({{0, 0}});
  const PlaceMeasures truth = places({{0, 1}});
  const BinMask region(judged.slope_deg.spec(), 1);
  Grid<float> p(region.spec(), 0.5F);
  const HazardScore score = score_hazards(judged, truth, {}, region, &p);
  EXPECT_EQ(score.roc[0].rates.missed_hazard_frac, 1);
  EXPECT_EQ(score.brier, 0.25);
  EXPECT_EQ(score.reliability[5].count, 1);
  EXPECT_EQ(score.reliability[5].safe_frac, 0);
  p.values()[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(score_hazards(judged, truth, {}, region, &p).brier);
}

TEST(SplitSigma, KnownNoiseLeavesTheRestToRelief) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<double> sigma(spec, 0.05);
  Grid<double> noise(spec, 0.03);
  sigma.at({2, 2}) = kNan;
  noise.at({3, 3}) = kNan;
  sigma.at({4, 4}) = 0.02;  // less than its noise, by rounding
  const SigmaParts parts = split_sigma(sigma, noise);
  EXPECT_NEAR(parts.noise_m.at({0, 0}), 0.03, 1e-8);
  EXPECT_NEAR(parts.relief_m.at({0, 0}), 0.04, 1e-8);
  EXPECT_NEAR(parts.noise_m.at({4, 4}), 0.02, 1e-8);
  EXPECT_EQ(parts.relief_m.at({4, 4}), 0);
  for (const BinIndex bin : {BinIndex{2, 2}, BinIndex{3, 3}})
    EXPECT_TRUE(std::isnan(parts.noise_m.at(bin)) && std::isnan(parts.relief_m.at(bin)));
}

TEST(SplitSigma, EqualSigmasAreNoise) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  const SigmaParts parts = split_sigma(Grid<double>(spec, 0.02), Footprint::square(3));
  for (std::size_t i = 0; i < spec.size(); ++i) {
    EXPECT_EQ(parts.noise_m.values()[i], 0.02F);
    EXPECT_NEAR(parts.relief_m.values()[i], 0, 1e-7);
  }
}

TEST(SplitSigma, AFewLargeSigmasAreRelief) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  Grid<double> sigma(spec, 0.01);
  sigma.at({10, 10}) = 0.05;
  sigma.at({3, 3}) = 0;
  sigma.at({17, 3}) = kNan;
  const SigmaParts parts = split_sigma(sigma, Footprint::square(3));
  const double typical = 1 / ((48 / 1e-4 + 1 / 25e-4) / 49);
  EXPECT_NEAR(parts.noise_m.at({10, 10}), std::sqrt(1.3 * typical), 1e-8);
  EXPECT_NEAR(parts.relief_m.at({10, 10}), std::sqrt(25e-4 - typical), 1e-8);
  EXPECT_NEAR(parts.noise_m.at({10, 11}), 0.01, 1e-8);
  EXPECT_EQ(parts.relief_m.at({10, 11}), 0);
  EXPECT_EQ(parts.noise_m.at({3, 3}), 0);
  EXPECT_TRUE(std::isnan(parts.noise_m.at({17, 3})));
}

// The window's mean counts the bins that have a precision.
TEST(SplitSigma, EqualsItsDefinition) {
  const GridSpec spec{0.1, -8, -20, 41, 17};
  const RandomField field(13, RandomStream::range_noise);
  Grid<double> sigma(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) sigma.values()[i] = 0.02 + 0.004 * field.normal(i);
  sigma.at({7, 7}) = 0;
  sigma.at({8, 7}) = kNan;
  const SigmaParts parts = split_sigma(sigma, Footprint::square(2));
  for (const auto [row, col] : bins_of(spec)) {
    const double here = sigma.at({row, col});
    if (!(here > 0)) continue;
    int count = 0;
    double sum = 0;
    for (const auto [r, c] : Bins({row - 2, col - 2}, {row + 2 + 1, col + 2 + 1})) {
      if (!spec.contains({r, c}) || !(sigma.at({r, c}) > 0)) continue;
      sum += 1 / (sigma.at({r, c}) * sigma.at({r, c}));
      ++count;
    }
    EXPECT_NEAR(parts.noise_m.at({row, col}), std::min(here, std::sqrt(1.3 * count / sum)), 1e-8);
    EXPECT_NEAR(parts.relief_m.at({row, col}), std::sqrt(std::max(here * here - count / sum, 0.0)), 1e-6);
  }
}

}  // namespace
}  // namespace landfall
