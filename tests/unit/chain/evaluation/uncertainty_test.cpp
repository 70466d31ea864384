// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "bins.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::_;
using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

// Scores 1, -2, 3 and, outside the region, 100.
TEST(Uncertainty, AbsoluteByHand) {
  const UncertaintyLayers layers{row_with<double>({0.5, -1, 1.5, 50, kNan, 1, 1, 1}),
                                 row_with<float>({0.5, 0.5, 0.5, 0.5, 1, 0, kFloatNan, HUGE_VALF}),
                                 row_with<float>({1, 1, 1, 1, 1, 1, 1, 1}),
                                 row_with<std::int32_t>({1, 2, 2, 1, 1, 1, 1, 1})};
  BinMask region(layers.error.spec(), 1);
  region.at({0, 3}) = 0;
  const ScoreMetrics scores = assess_uncertainty(layers, region, Footprint::square(0)).absolute;
  EXPECT_EQ(scores.count, 3);
  EXPECT_EQ(scores.left_out_count, 3);
  EXPECT_DOUBLE_EQ(scores.mean.value(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(scores.std.value(), std::sqrt(14.0 / 3 - 4.0 / 9));
  EXPECT_EQ(scores.within_1_sigma_frac, 1.0 / 3);
  EXPECT_EQ(scores.within_2_sigma_frac, 2.0 / 3);
  EXPECT_EQ(scores.by_count, (ScoreMetrics::ByCount{{1, 2}, {1, 2}, {0, 2.5}, {1, 0}, {1, 0.5}}));
  EXPECT_THAT(scores.reliability.sigma_m, ElementsAre(0.5));
  EXPECT_THAT(scores.reliability.rmse_m, ElementsAre(DoubleEq(std::sqrt(3.5 / 3))));
  EXPECT_THAT(scores.reliability.bins, ElementsAre(3));
  const ScoreMetrics::WithinSigmas& within = scores.within_k_sigma;
  ASSERT_EQ(within.k.size(), 16U);
  ASSERT_EQ(within.frac.size(), 16U);
  EXPECT_EQ(std::pair(within.k[2], within.frac[2]), std::pair(0.75, 0.0));
  EXPECT_EQ(std::pair(within.k[3], within.frac[3]), std::pair(1.0, 1.0 / 3));
  EXPECT_EQ(within.frac[7], scores.within_2_sigma_frac);
  EXPECT_EQ(std::pair(within.k[15], within.frac[15]), std::pair(4.0, 1.0));
}

// Means 3, 4 and 5 of the footprints of 2, 3 and 2 bins; the lone bin behind the gap says nothing.
TEST(Uncertainty, RelativeIsTheErrorLessItsFootprintsMean) {
  const Grid<float> ones = row_with<float>({1, 1, 1, 1, 1, 1});
  const UncertaintyLayers layers{row_with<double>({2, 4, 6, kNan, kNan, 9}), ones, ones, std::nullopt};
  const ScoreMetrics scores =
      assess_uncertainty(layers, BinMask(ones.spec(), 1), Footprint::square(1)).relative;
  EXPECT_EQ(scores.count, 3);  // -1, 0, 1
  EXPECT_EQ(scores.left_out_count, 0);
  EXPECT_EQ(scores.mean, 0);
  EXPECT_DOUBLE_EQ(scores.std.value(), std::sqrt(2.0 / 3));
  EXPECT_EQ(scores.within_1_sigma_frac, 1);
  EXPECT_EQ(scores.by_count, ScoreMetrics::ByCount{});
}

TEST(Uncertainty, SharesEndAtFourSigma) {
  const UncertaintyLayers layers{row_with<double>({4, -3.9, 4.1, 3.75, 0}), row_with<float>({1, 1, 1, 1, 1}),
                                 row_with<float>({1, 1, 1, 1, 1}), std::nullopt};
  const ScoreMetrics scores =
      assess_uncertainty(layers, BinMask(layers.error.spec(), 1), Footprint::square(0)).absolute;
  const ScoreMetrics::WithinSigmas& within = scores.within_k_sigma;
  EXPECT_EQ(std::pair(within.k.at(0), within.frac.at(0)), std::pair(0.25, 0.2));
  EXPECT_EQ(std::pair(within.k.at(14), within.frac.at(14)), std::pair(3.75, 0.4));
  EXPECT_EQ(std::pair(within.k.at(15), within.frac.at(15)), std::pair(4.0, 0.8));
}

TEST(Uncertainty, OneScoreOrNone) {
  const UncertaintyLayers layers{row_with<double>({0.5, 1, 1}), row_with<float>({1, 0, -1}),
                                 row_with<float>({kFloatNan, 0, 0}), std::nullopt};
  const UncertaintyMetrics metrics =
      assess_uncertainty(layers, BinMask(layers.error.spec(), 1), Footprint::square(1));
  EXPECT_EQ(metrics.absolute.count, 1);
  EXPECT_EQ(metrics.absolute.left_out_count, 2);
  EXPECT_EQ(metrics.absolute.mean, 0.5);
  EXPECT_EQ(metrics.absolute.std, 0);
  EXPECT_EQ(metrics.relative.count, 0);
  EXPECT_EQ(metrics.relative.left_out_count, 3);
  EXPECT_EQ(metrics.relative.mean, std::nullopt);
  EXPECT_EQ(metrics.relative.within_k_sigma, ScoreMetrics::WithinSigmas{});
}

TEST(Uncertainty, StepsOfSigmaAscend) {
  const UncertaintyLayers layers{row_with<double>({1, 1, 1, 1, 1}),
                                 row_with<float>({1, 2, 1.25F, 1.1F, 0.001F}),
                                 row_with<float>({1, 1, 1, 1, 1}), std::nullopt};
  const ScoreMetrics scores =
      assess_uncertainty(layers, BinMask(layers.error.spec(), 1), Footprint::square(0)).absolute;
  EXPECT_THAT(scores.reliability.sigma_m, ElementsAre(DoubleNear(0.001, 1e-9), _, 1.25, 2.0));
  EXPECT_THAT(scores.reliability.bins, ElementsAre(1, 2, 1, 1));  // 1 and 1.1 lie below the fourth root of 2
}

// Errors drawn with the sigma that the map says: 68.3 and 95.4 %, bounds of five standard errors at 250,000
// bins.
TEST(Uncertainty, AnHonestMapAtAnyThreadCount) {
  const GridSpec spec{1, 0, 0, 500, 500};
  const RandomField draw(4, RandomStream::range_noise);
  UncertaintyLayers layers{Grid<double>(spec), Grid<float>(spec), Grid<float>(spec), std::nullopt};
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const float sigma = 0.01F * std::exp(static_cast<float>(draw.normal(i, 1)));
    layers.sigma_abs.values()[i] = layers.sigma_rel.values()[i] = sigma;
    layers.error.values()[i] = static_cast<double>(sigma) * draw.normal(i, 0);
  }
  const BinMask everywhere(spec, 1);
  const UncertaintyMetrics metrics = assess_uncertainty(layers, everywhere, Footprint::square(17));
  EXPECT_NEAR(metrics.absolute.std.value(), 1, 0.0071);
  EXPECT_NEAR(metrics.absolute.within_1_sigma_frac.value(), 0.6827, 0.0047);
  EXPECT_NEAR(metrics.absolute.within_2_sigma_frac.value(), 0.9545, 0.0021);
  const ScoreMetrics::Reliability& reliability = metrics.absolute.reliability;
  for (std::size_t i = 0; i < reliability.bins.size(); ++i)
    if (reliability.bins[i] > 1000) {
      EXPECT_NEAR(reliability.rmse_m[i] / reliability.sigma_m[i], 1, 0.12);
    }
  const ThreadLimit limit(7);
  EXPECT_EQ(assess_uncertainty(layers, everywhere, Footprint::square(17)), metrics);
}

TEST(Uncertainty, RefusesAnotherGrid) {
  const Grid<float> ones = row_with<float>({1, 1});
  const UncertaintyLayers layers{row_with<double>({1, 1}), ones, row_with<float>({1}), std::nullopt};
  EXPECT_THROW(static_cast<void>(assess_uncertainty(layers, BinMask(ones.spec(), 1), Footprint::square(0))),
               FormatError);
  const auto refused = [](std::size_t error, std::size_t abs, std::size_t rel, std::size_t count) {
    const auto spec = [](std::size_t cols) { return GridSpec{1, 0, 0, 1, static_cast<std::int64_t>(cols)}; };
    const UncertaintyLayers some{Grid<double>(spec(error)), Grid<float>(spec(abs), 1),
                                 Grid<float>(spec(rel), 1), Grid<std::int32_t>(spec(count), 1)};
    return refusal<FormatError>([&] {
             return assess_uncertainty(some, BinMask(spec(2), 1), Footprint::square(0));
           }) != "accepted";
  };
  EXPECT_FALSE(refused(2, 2, 2, 2));
  EXPECT_TRUE(refused(3, 2, 2, 2));
  EXPECT_TRUE(refused(2, 3, 2, 2));
  EXPECT_TRUE(refused(2, 2, 3, 2));
  EXPECT_TRUE(refused(2, 2, 2, 3));
}

}  // namespace
}  // namespace landfall
