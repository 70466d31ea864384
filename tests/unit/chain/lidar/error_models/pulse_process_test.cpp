// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "chain/lidar/error_models/pulse_process.h"
#include "chain/lidar/error_models/random_navigation_error.h"
#include "chain/lidar/error_models/sampled_path.h"
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

const RandomField kField(5, RandomStream::navigation_walk);

Eigen::Vector3d draws(std::uint64_t step, std::uint64_t first_axis) {
  return {kField.normal(step, first_axis), kField.normal(step, first_axis + 1),
          kField.normal(step, first_axis + 2)};
}

TEST(TimeGrid, ReachesTheDurationInWholeSteps) {
  EXPECT_EQ(TimeGrid::covering(2, 0.5).steps, 4U);
  EXPECT_EQ(TimeGrid::covering(2.1, 0.5).steps, 5U);
  EXPECT_EQ(TimeGrid::covering(2, 0.5).interval_s, 0.5);
  EXPECT_EQ(TimeGrid::covering(0, 0.5).steps, 1U);
  EXPECT_EQ(TimeGrid::covering(1e6, 1).steps, 1000000U);
  EXPECT_THROW(static_cast<void>(TimeGrid::covering(1e6 + 0.5, 1)), UsageError);
  EXPECT_EQ(TimeGrid{}.interval_s, 0.01);
  EXPECT_EQ(RandomNavigationParameters{}.interval_s, 0.01);
  EXPECT_EQ(RandomNavigationError::Draw{}.duration_s, 2);
}

TEST(TimeGrid, HasNoStepAtFirst) { EXPECT_EQ(TimeGrid{}.steps, 0U); }

TEST(SampledPath, IsLinearBetweenItsPointsAndConstantOutside) {
  const SampledPath path({0.5, 2}, {{0, 10, -1}, {2, 20, -1}, {6, 0, -1}});
  EXPECT_EQ(path.at(-1), Eigen::Vector3d(0, 10, -1));
  EXPECT_EQ(path.at(0.125), Eigen::Vector3d(0.5, 12.5, -1));
  EXPECT_EQ(path.at(0.5), Eigen::Vector3d(2, 20, -1));
  EXPECT_EQ(path.at(0.75), Eigen::Vector3d(4, 10, -1));
  EXPECT_EQ(path.at(1), Eigen::Vector3d(6, 0, -1));
  EXPECT_EQ(path.at(9), Eigen::Vector3d(6, 0, -1));
}

// Trapezoids of width 0.5: (0 + 2) / 4, then (2 + 6) / 4 more.
TEST(SampledPath, SumsAndIntegratesPointByPoint) {
  SampledPath path({0.5, 2}, {{0, 1, 0}, {2, 1, 0}, {6, 1, 0}});
  const SampledPath integral = path.integral();
  EXPECT_EQ(integral.at(0), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(integral.at(0.5), Eigen::Vector3d(0.5, 0.5, 0));
  EXPECT_EQ(integral.at(1), Eigen::Vector3d(2.5, 1, 0));
  path += integral;
  EXPECT_EQ(path.at(0), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(path.at(1), Eigen::Vector3d(8.5, 2, 0));
  path += path;
  EXPECT_EQ(path.at(0), Eigen::Vector3d(0, 2, 0));
}

TEST(SampledPath, ARandomWalkAddsScaledDraws) {
  const SampledPath walk = random_walk({0.25, 3}, {1, 2, 4}, {kField, 3});
  EXPECT_EQ(walk.at(0), Eigen::Vector3d(0, 0, 0));
  const Eigen::Vector3d scale(0.5, 1, 2);
  EXPECT_EQ(walk.at(0.25), scale.cwiseProduct(draws(1, 3)));
  EXPECT_EQ(walk.at(0.5), scale.cwiseProduct(draws(1, 3)) + scale.cwiseProduct(draws(2, 3)));
}

TEST(SampledPath, AGaussMarkovProcessForgetsAndRenews) {
  const Eigen::Vector3d sigma(1, 2, 4);
  const SampledPath path = gauss_markov({0.25, 3}, {sigma, 0.5}, {kField, 6});
  const double kept = std::exp(-0.5);
  const double renewed = std::sqrt(1 - kept * kept);
  const Eigen::Vector3d first = sigma.cwiseProduct(draws(0, 6));
  EXPECT_EQ(path.at(0), first);
  const Eigen::Vector3d second = kept * first + renewed * sigma.cwiseProduct(draws(1, 6));
  EXPECT_LT((path.at(0.25) - second).norm(), 1e-15);
  EXPECT_LT((path.at(0.5) - kept * second - renewed * sigma.cwiseProduct(draws(2, 6))).norm(), 1e-15);
}

/// A process of three axes: what it draws for a step.
Eigen::Vector3d drawn(RandomStream stream, std::uint64_t step, std::uint64_t first_axis) {
  const RandomField field(7, stream);
  return {field.normal(step, first_axis), field.normal(step, first_axis + 1),
          field.normal(step, first_axis + 2)};
}

// Position draws on axes 0 to 2, velocity on 3 to 5, attitude on 6 to 8 (docs/reference/draws.md).
TEST(RandomNavigationError, EachProcessHasItsAxesAndItsTime) {
  const auto error_of = [](const RandomNavigationParameters& p) {
    return RandomNavigationError({}, p, {7, 2}).error(0.25);
  };
  const auto walk = RandomStream::navigation_walk;
  const auto markov = RandomStream::gauss_markov;
  EXPECT_EQ(error_of({.random_walk = {.position_m_per_sqrt_s = {{1, 1, 1}}}, .interval_s = 0.25}).p_err.v,
            0.5 * drawn(walk, 1, 0));
  // The integral of the first step: half of its end, times the interval.
  EXPECT_EQ(error_of({.random_walk = {.velocity_mps_per_sqrt_s = {{1, 1, 1}}}, .interval_s = 0.25}).p_err.v,
            0.125 * 0.5 * drawn(walk, 1, 3));
  const Eigen::Vector3d turn = 0.5 * drawn(walk, 1, 6);
  EXPECT_EQ(error_of({.random_walk = {.rpy_rad_per_sqrt_s = {1, 1, 1}}, .interval_s = 0.25}).R_err.m,
            rotation_matrix({turn.x(), turn.y(), turn.z()}));
  const auto after = [&](std::uint64_t axis, double time_s) {
    const double kept = std::exp(-0.25 / time_s);
    return Eigen::Vector3d(kept * drawn(markov, 0, axis) +
                           std::sqrt(1 - kept * kept) * drawn(markov, 1, axis));
  };
  const auto one_of = [&](const GaussMarkovParameters& p) {
    return error_of({.gauss_markov = p, .interval_s = 0.25});
  };
  EXPECT_LT((one_of({.position_sigma_m = {{1, 1, 1}}, .position_time_s = 3}).p_err.v - after(0, 3)).norm(),
            1e-14);
  EXPECT_LT((one_of({.velocity_sigma_mps = {{1, 1, 1}}, .velocity_time_s = 4}).p_err.v -
             0.125 * (drawn(markov, 0, 3) + after(3, 4)))
                .norm(),
            1e-14);
  const Eigen::Vector3d rpy = after(6, 5);
  EXPECT_LT((one_of({.rpy_sigma_rad = {1, 1, 1}, .rpy_time_s = 5}).R_err.m -
             rotation_matrix({rpy.x(), rpy.y(), rpy.z()}))
                .norm(),
            1e-14);
}

}  // namespace
}  // namespace landfall
