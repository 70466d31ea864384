// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/core/error.h"
#include "chain/lidar/error_models/navigation_error.h"
#include "chain/lidar/error_models/random_navigation_error.h"
#include "constants.h"
#include "refusal.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Pose = Transform<DemFrame, BodyFrame>;

const Pose kTruth{rotation_from<DemFrame, BodyFrame>({0, 0, kPi / 2}), {{10, 20, 500}}};

TEST(LinearNavigationError, NoneIsTheTruth) {
  EXPECT_EQ(LinearNavigationError({}).estimated(kTruth, 1.5), kTruth);
}

// Eq. 4, position: the error is truth - estimate, so the estimate lies lower by it, in the DEM's axes.
TEST(LinearNavigationError, PositionErrorIsSubtracted) {
  const LinearNavigationError error({.position_m = {{1, -2, 3}}});
  const Pose estimate = error.estimated(kTruth, 0);
  EXPECT_EQ(estimate.position.v, Eigen::Vector3d(9, 22, 497));
  EXPECT_EQ(estimate.rotation, kTruth.rotation);
}

// Eq. 4, rotation: the truth yaws by 90 deg; a roll error of +90 deg comes first, in the body. It takes the
// body's y to z, where the truth leaves it: R_est e_y = R R_err e_y = R e_z = e_z. (Multiplied on the left it
// would be R_err R e_y = -e_x.)
TEST(LinearNavigationError, RotationErrorIsAppliedInTheBody) {
  const LinearNavigationError error({.rpy = {kPi / 2, 0, 0}});
  const Pose estimate = error.estimated(kTruth, 0);
  EXPECT_EQ(estimate.rotation.m * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(estimate.rotation.m * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  EXPECT_EQ(estimate.position, kTruth.position);
}

// Eq. 6 at t = 2: p_err = (1, 0, 0) + 2 (0.3, 0.3, 0.7), yaw error = 0.1 + 2 * 0.2.
TEST(LinearNavigationError, GrowsLinearly) {
  const LinearNavigationError error({.position_m = {{1, 0, 0}},
                                     .velocity_mps = {{0.3, 0.3, 0.7}},
                                     .rpy = {0, 0, 0.1},
                                     .rpy_rate_radps = {0, 0, 0.2}});
  const Pose estimate = error.estimated(kTruth, 2);
  EXPECT_LT((estimate.position.v - Eigen::Vector3d(8.4, 19.4, 498.6)).norm(), 1e-13);
  EXPECT_LT((estimate.rotation.m - rotation_matrix({0, 0, kPi / 2 + 0.5})).norm(), 1e-15);
}

TEST(LinearNavigationError, RefusesWhatIsNotFinite) {
  const double nan = std::nan("");
  EXPECT_THROW(LinearNavigationError({.position_m = {{nan, 0, 0}}}), UsageError);
  EXPECT_THROW(LinearNavigationError({.velocity_mps = {{0, HUGE_VAL, 0}}}), UsageError);
  EXPECT_THROW(LinearNavigationError({.rpy = {0, 0, nan}}), UsageError);
  EXPECT_THROW(LinearNavigationError({.rpy_rate_radps = {nan, 0, 0}}), UsageError);
}

// Variances over many seeds are compared with theory within 5 standard errors of a normal sample variance,
// sqrt(2 / N): a right generator fails one comparison in 1.7 million, this whole file one run in some 30,000.
constexpr std::uint64_t kDraws = 2000;

/// The mean over many seeds of value(seed), a product of two numbers, per axis.
Eigen::Vector3d mean_over_seeds(const std::function<Eigen::Vector3d(std::uint64_t seed)>& value) {
  const std::uint64_t first = test_seed();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::uint64_t seed = first; seed < first + kDraws; ++seed) sum += value(seed);
  return sum / static_cast<double>(kDraws);
}

void expect_variance(const Eigen::Vector3d& measured, const Eigen::Vector3d& theory) {
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(measured[axis] / theory[axis], 1, 5 * std::sqrt(2.0 / kDraws)) << "axis " << axis;
}

Eigen::Vector3d squares(const Eigen::Vector3d& v) { return v.cwiseProduct(v); }

/// p_err at a time, of a scan with only these random errors.
Eigen::Vector3d position_error(const RandomNavigationParameters& p, std::uint64_t seed, double t_s) {
  return RandomNavigationError({}, p, {seed, 2}).error(t_s).p_err.v;
}

/// The turn of R_err about the body's axes; exact for small angles to their square.
Eigen::Vector3d attitude_error(const RandomNavigationParameters& p, std::uint64_t seed, double t_s) {
  const Eigen::Matrix3d R = RandomNavigationError({}, p, {seed, 2}).error(t_s).R_err.m;
  return {R(2, 1), R(0, 2), R(1, 0)};
}

TEST(RandomWalk, VarianceGrowsWithTime) {
  const RandomNavigationParameters p{
      .random_walk = {.position_m_per_sqrt_s = {{0.1, 0.2, 0.3}}, .rpy_rad_per_sqrt_s = {1e-4, 2e-4, 3e-4}}};
  EXPECT_EQ(position_error(p, 1, 0), Eigen::Vector3d::Zero());
  for (const double t : {0.5, 2.0}) {
    expect_variance(mean_over_seeds([&](auto seed) { return squares(position_error(p, seed, t)); }),
                    t * squares({0.1, 0.2, 0.3}));
    expect_variance(mean_over_seeds([&](auto seed) { return squares(attitude_error(p, seed, t)); }),
                    t * squares({1e-4, 2e-4, 3e-4}));
  }
}

// Halfway between two points of the grid the walk is their mean: q^2 (t_n + h / 4), not q^2 (t_n + h / 2).
TEST(RandomWalk, IsLinearBetweenPointsOfTheGrid) {
  const RandomNavigationParameters p{.random_walk = {.position_m_per_sqrt_s = {{1, 1, 1}}},
                                     .interval_s = 0.5};
  const Eigen::Vector3d a = position_error(p, 1, 0.5);
  const Eigen::Vector3d b = position_error(p, 1, 1.0);
  EXPECT_LT((position_error(p, 1, 0.75) - (a + b) / 2).norm(), 1e-15);
  EXPECT_EQ(position_error(p, 1, -3), position_error(p, 1, 0));
  EXPECT_EQ(position_error(p, 1, 2.7), position_error(p, 1, 2));
}

// A walk of velocity, integrated: Var p = q^2 t^3 / 3. With h = 0.02 s the trapezoidal sum of a walk of t / h
// steps differs from it by less than h / t = 1 %; the exact sum is q^2 h^3 (n^3 / 3 - n / 12).
TEST(RandomWalk, VelocityIntegratesIntoPosition) {
  constexpr double kInterval_s = 0.02;
  const RandomNavigationParameters p{.random_walk = {.velocity_mps_per_sqrt_s = {{0.1, 0.2, 0.3}}},
                                     .interval_s = kInterval_s};
  const double n = 2 / kInterval_s;
  const double growth = std::pow(kInterval_s, 3) * (n * n * n / 3 - n / 12);
  EXPECT_NEAR(growth, 8.0 / 3, 1e-3);
  expect_variance(mean_over_seeds([&](auto seed) { return squares(position_error(p, seed, 2)); }),
                  growth * squares({0.1, 0.2, 0.3}));
}

TEST(GaussMarkovError, IsStationary) {
  const RandomNavigationParameters p{.gauss_markov = {.position_sigma_m = {{1, 2, 3}},
                                                      .position_time_s = 0.4,
                                                      .rpy_sigma_rad = {1e-4, 2e-4, 3e-4}}};
  for (const double t : {0.0, 0.37, 2.0}) {
    expect_variance(mean_over_seeds([&](auto seed) { return squares(position_error(p, seed, t)); }),
                    squares({1, 2, 3}));
    expect_variance(mean_over_seeds([&](auto seed) { return squares(attitude_error(p, seed, t)); }),
                    squares({1e-4, 2e-4, 3e-4}));
  }
}

// E x(t) x(t + d) = sigma^2 exp(-d / tau); the standard error of a mean product of two normals of correlation
// rho is sqrt((1 + rho^2) / N).
TEST(GaussMarkovError, ForgetsExponentially) {
  const RandomNavigationParameters p{
      .gauss_markov = {.position_sigma_m = {{1, 1, 1}}, .position_time_s = 0.4}};
  for (const double lag : {0.1, 0.4, 1.2}) {
    const double rho = std::exp(-lag / 0.4);
    const Eigen::Vector3d product = mean_over_seeds([&](auto seed) {
      const RandomNavigationError error({}, p, {seed, 2});
      return Eigen::Vector3d(error.error(0.5).p_err.v.cwiseProduct(error.error(0.5 + lag).p_err.v));
    });
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(product[axis], rho, 5 * std::sqrt((1 + rho * rho) / kDraws)) << lag;
  }
}

// Integrated: Var p = 2 sigma^2 tau (t - tau (1 - exp(-t / tau))).
TEST(GaussMarkovError, VelocityIntegratesIntoPosition) {
  const RandomNavigationParameters p{
      .gauss_markov = {.velocity_sigma_mps = {{0.1, 0.2, 0.3}}, .velocity_time_s = 0.5}};
  const double growth = 2 * 0.5 * (2 - 0.5 * (1 - std::exp(-4)));
  expect_variance(mean_over_seeds([&](auto seed) { return squares(position_error(p, seed, 2)); }),
                  growth * squares({0.1, 0.2, 0.3}));
}

TEST(RandomNavigationError, AxesAndProcessesAreIndependent) {
  const RandomNavigationParameters p{.random_walk = {.position_m_per_sqrt_s = {{1, 1, 1}}},
                                     .gauss_markov = {.position_sigma_m = {{1, 1, 1}}}};
  RandomNavigationParameters markov = p;
  markov.random_walk = {};
  const Eigen::Vector3d products = mean_over_seeds([&](auto seed) {
    const Eigen::Vector3d both = position_error(p, seed, 1);
    const Eigen::Vector3d one = position_error(markov, seed, 1);
    const Eigen::Vector3d other = both - one;
    return Eigen::Vector3d(one.x() * one.y(), other.x() * other.z(), one.x() * other.x());
  });
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(products[i], 0, 5 / std::sqrt(double{kDraws})) << i;
}

// R_err = R_linear R_walk R_gauss_markov, from parts that are drawn alone: switching one process on changes
// no draw of another.
TEST(RandomNavigationError, IsTheProductOfItsPartsInOrder) {
  const NavigationErrorParameters linear{.position_m = {{1, 2, 3}}, .rpy = {0.3, 0.1, 0.2}};
  const RandomWalkParameters walk{{{0.1, 0.1, 0.1}}, {{0.2, 0.2, 0.2}}, {0.4, 0.4, 0.4}};
  const GaussMarkovParameters markov{{{0.5, 0.5, 0.5}}, 1, {{0.1, 0.1, 0.1}}, 2, {0.5, 0.5, 0.5}, 3};
  const RandomNavigationError::Draw draw{7, 2};
  const PoseError a = LinearNavigationError(linear).error(1.234);
  const PoseError b = RandomNavigationError({}, {.random_walk = walk}, draw).error(1.234);
  const PoseError c = RandomNavigationError({}, {.gauss_markov = markov}, draw).error(1.234);
  const RandomNavigationError all(linear, {walk, markov}, draw);
  const PoseError whole = all.error(1.234);
  EXPECT_LT((whole.R_err.m - a.R_err.m * b.R_err.m * c.R_err.m).norm(), 1e-15);
  EXPECT_GT((whole.R_err.m - c.R_err.m * b.R_err.m * a.R_err.m).norm(), 1e-3);
  EXPECT_LT((whole.p_err.v - a.p_err.v - b.p_err.v - c.p_err.v).norm(), 1e-15);
  const Pose truth{rotation_from<DemFrame, BodyFrame>({0, 0, 1}), {{10, 20, 500}}};
  const Pose estimate = all.estimated(truth, 1.234);
  EXPECT_EQ(estimate.position, truth.position - whole.p_err);
  EXPECT_EQ(estimate.rotation, truth.rotation * whole.R_err);
}

TEST(RandomNavigationError, WithoutRandomErrorsIsEquationSix) {
  const NavigationErrorParameters linear{.position_m = {{1, 2, 3}},
                                         .velocity_mps = {{0.3, 0.3, 0.7}},
                                         .rpy = {0.01, 0, 0},
                                         .rpy_rate_radps = {0, 0.1, 0}};
  const Pose truth{rotation_from<DemFrame, BodyFrame>({0.1, 0.2, 1}), {{10, 20, 500}}};
  for (const double t : {0.0, 0.123, 1.9})
    EXPECT_EQ(RandomNavigationError(linear, {}, {1, 2}).estimated(truth, t),
              LinearNavigationError(linear).estimated(truth, t));
}

// The draws are functions of (seed, step, axis): a longer scan begins as a shorter one does.
TEST(RandomNavigationError, DurationChangesNoDraw) {
  const RandomNavigationParameters p{.random_walk = {.position_m_per_sqrt_s = {{1, 1, 1}}},
                                     .gauss_markov = {.rpy_sigma_rad = {1, 1, 1}}};
  const RandomNavigationError brief({}, p, {3, 1});
  const RandomNavigationError lasting({}, p, {3, 50});
  for (double t = 0; t < 1; t += 0.0123) {
    EXPECT_EQ(brief.error(t).p_err, lasting.error(t).p_err);
    EXPECT_EQ(brief.error(t).R_err, lasting.error(t).R_err);
  }
  EXPECT_NE(brief.error(0.5).p_err, RandomNavigationError({}, p, {4, 1}).error(0.5).p_err);
}

TEST(RandomNavigationError, TheFirstSeedIsOne) { EXPECT_EQ(RandomNavigationError::Draw{}.seed, 1U); }

TEST(RandomNavigationError, ItsGridIsCheckedBeforeAnythingIsDrawn) {
  EXPECT_NO_THROW(RandomNavigationError::require_valid({.interval_s = 0.1}, 2));
  EXPECT_THROW(RandomNavigationError::require_valid({.interval_s = 0}, 2), UsageError);
}

TEST(RandomNavigationError, RefusesWhatIsOutOfRange) {
  const auto refused = [](const RandomNavigationParameters& p, const char* message) {
    EXPECT_THAT(refusal([&] {
                  const RandomNavigationError error({}, p, {1, 2});
                }),
                testing::HasSubstr(message));
  };
  refused({.random_walk = {.position_m_per_sqrt_s = {{0, -1, 0}}}},
          "random_walk/position_m_per_sqrt_s/1: -1 is not finite and >= 0");
  refused({.random_walk = {.velocity_mps_per_sqrt_s = {{HUGE_VAL, 0, 0}}}}, "velocity_mps_per_sqrt_s/0");
  refused({.random_walk = {.rpy_rad_per_sqrt_s = {0, 0, -1}}}, "rpy_rad_per_sqrt_s/2");
  refused({.gauss_markov = {.position_sigma_m = {{0, 0, std::nan("")}}}}, "position_sigma_m/2");
  refused({.gauss_markov = {.position_time_s = 0}},
          "gauss_markov/position_time_s: 0 is not finite and positive");
  refused({.gauss_markov = {.velocity_sigma_mps = {{-1, 0, 0}}}}, "velocity_sigma_mps/0");
  refused({.gauss_markov = {.velocity_time_s = -1}}, "velocity_time_s");
  refused({.gauss_markov = {.rpy_sigma_rad = {-1, 0, 0}}}, "rpy_sigma_rad/0");
  refused({.gauss_markov = {.rpy_time_s = HUGE_VAL}}, "rpy_time_s");
  refused({.interval_s = 0}, "interval_s: 0 is not finite and positive");
  refused({.interval_s = 1.9e-6},
          "long enough: 2 s, the scan and its time-stamp errors, would have more than a million steps");
}

}  // namespace
}  // namespace landfall
