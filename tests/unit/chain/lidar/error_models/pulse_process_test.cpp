// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/error_models/pulse_process.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test_seed.h"

namespace landfall {
namespace {

RandomField field(std::uint64_t seed) { return {seed, RandomStream::pointing_jitter}; }

TEST(PulseProcess, WithoutMemoryItIsTheDrawOfThePulse) {
  const PulseProcess process(1000);
  const RandomField draws = field(7);
  for (const std::int64_t pulse : {0L, 1L, 2L, 77L, 2147483647L})
    EXPECT_EQ(process.at(pulse, draws, 1), draws.normal(static_cast<std::uint64_t>(pulse), 1));
}

// Block of two pulses: 20 < h/tau <= 40, worked by hand.
TEST(PulseProcess, TheMiddleOfTwoPulses) {
  const double share = 30;
  const PulseProcess process(share);
  const RandomField draws = field(7);
  const double last =
      std::exp(-2 * share) * draws.normal(4, 0) + std::sqrt(-std::expm1(-4 * share)) * draws.normal(6, 0);
  EXPECT_EQ(process.at(4, draws, 0), draws.normal(4, 0));
  EXPECT_DOUBLE_EQ(process.at(5, draws, 0), (draws.normal(4, 0) + last) / (2 * std::cosh(share)) +
                                                std::sqrt(std::tanh(share)) * draws.normal(5, 0));
}

// Over 4000 seeds the products have standard errors of at most sqrt(2/4000): 5 of them.
TEST(PulseProcess, HasItsCovarianceAtAnyPulses) {
  constexpr int kSeeds = 4000;
  for (const double share : {0.7, 0.05, 1e-6})
    for (const std::int64_t first : {0L, 1023L, 2147000000L})
      for (const std::int64_t apart : {0L, 1L, 17L, 100000L}) {
        const PulseProcess process(share);
        double sum = 0;
        for (int seed = 0; seed < kSeeds; ++seed) {
          const RandomField draws = field(test_seed() + static_cast<std::uint64_t>(seed));
          sum += process.at(first, draws, 0) * process.at(first + apart, draws, 0);
        }
        EXPECT_NEAR(sum / kSeeds, std::exp(-share * static_cast<double>(apart)), 5 * std::sqrt(2.0 / kSeeds))
            << share << ' ' << first << ' ' << apart;
      }
}

// Within one realisation: neighbours differ by sqrt(2 (1 - e^-share)), which a wrong value anywhere in the
// tree would exceed. 2^17 differences of at most 6 sigma: a right one fails once in 4,000 seeds.
TEST(PulseProcess, NeighboursAreClose) {
  const double share = 1e-4;
  const PulseProcess process(share);
  const RandomField draws = field(3);
  const double sigma = std::sqrt(-2 * std::expm1(-share));
  double before = process.at(0, draws, 0);
  double squares = 0;
  constexpr std::int64_t kPulses = 1 << 17;
  for (std::int64_t pulse = 1; pulse <= kPulses; ++pulse) {
    const double now = process.at(pulse, draws, 0);
    ASSERT_LT(std::abs(now - before), 6 * sigma) << pulse;
    squares += (now - before) * (now - before);
    before = now;
  }
  EXPECT_NEAR(squares / kPulses / (sigma * sigma), 1, 5 * std::sqrt(2.0 / kPulses));
}

}  // namespace
}  // namespace landfall
