// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/sigma_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "base/numerics/random.h"
#include "constants.h"

namespace landfall {
namespace {

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
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const double here = sigma.at({row, col});
      if (!(here > 0)) continue;
      int count = 0;
      double sum = 0;
      for (std::int64_t r = row - 2; r <= row + 2; ++r)
        for (std::int64_t c = col - 2; c <= col + 2; ++c) {
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
