// SPDX-License-Identifier: GPL-3.0-or-later
// The effects of errors of range, pointing, time stamps and navigation on a scan, in closed form:
// one pixel that looks straight down.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analytic_engines.h"
#include "base/core/error.h"
#include "bins.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "points.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using enum PointStatus;

constexpr double kHeight_m = 500;
const Vector3d kVelocity_mps(3, 4, -23);

struct Errors {
  RangeErrorParameters range{};
  PointingErrorParameters pointing{};
};

/// 100 pulses in 0.1 s.
ScanModel scan(const Errors& errors, const Vector3d& velocity_mps = kVelocity_mps) {
  return ScanModel{.lidar = {.detector = perspective_detector({.rows = 1, .columns = 1}),
                             .scanner = std::make_unique<Flash>(),
                             .range_errors = RangeErrors(errors.range, 1),
                             .pointing_error = PointingError(errors.pointing, 1)},
                   .trajectory = std::make_unique<ConstantVelocity>(ConstantVelocityParameters{
                       .position_m = {{0, 0, kHeight_m}}, .velocity_mps = {velocity_mps}}),
                   .pulse_rate_hz = 1000,
                   .scan_time_s = 0.1};
}

PulseBatch simulate(ScanModel model, const RayEngine& engine, const TriangulatedGrid* terrain = nullptr) {
  return Simulation(std::move(model), &engine, terrain).simulate({0, 100});
}

PulseBatch simulate(const Errors& errors, const RayEngine& engine,
                    const TriangulatedGrid* terrain = nullptr) {
  return simulate(scan(errors), engine, terrain);
}

Vector3d lander(std::size_t i, double later_s = 0) {
  return Vector3d(0, 0, kHeight_m) + (1e-3 * static_cast<double>(i) + later_s) * kVelocity_mps;
}

// A lidar askew by a about x_L looks to +y_D, about y_L to +x_D, by h tan a; the estimate is put straight
// down.
TEST(ErrorEffects, MisalignmentMovesTheFootprint) {
  constexpr double kAngle = 0.01;
  const PlaneEngine engine;
  const PulseBatch about_x = simulate({.pointing = {.misalignment = {kAngle, 0, 0}}}, engine);
  const PulseBatch about_y = simulate({.pointing = {.misalignment = {0, kAngle, 0}}}, engine);
  for (const std::size_t i : {0U, 99U}) {
    const double h = lander(i).z();
    const Vector3d below(lander(i).x(), lander(i).y(), 0);
    EXPECT_LT((true_point(about_x, i) - below - Vector3d(0, h * std::tan(kAngle), 0)).norm(), 1e-12);
    EXPECT_LT((true_point(about_y, i) - below - Vector3d(h * std::tan(kAngle), 0, 0)).norm(), 1e-12);
    EXPECT_LT((estimated_point(about_x, i) - below - Vector3d(0, 0, h - h / std::cos(kAngle))).norm(), 1e-12);
    EXPECT_EQ(about_x.points.range_measured[i], about_x.points.range_true[i]);
  }
}

TEST(ErrorEffects, TheExitPointTurnsWithTheLidarAboutItsOwnOrigin) {
  const PlaneEngine engine;
  ScanModel model = scan({.pointing = {.misalignment = {0.01, 0, 0}}}, {0, 0, 0});
  model.lidar.mount.position.v = {7, 8, -2};
  const PulseBatch batch = simulate(std::move(model), engine);
  EXPECT_LT((true_point(batch, 0) - Vector3d(7, 8 + 498 * std::tan(0.01), 0)).norm(), 1e-12);
}

TEST(ErrorEffects, JitterMovesTrueBeamsOnly) {
  const PlaneEngine engine;
  const PulseBatch batch = simulate({.pointing = {.jitter_sigma_x_rad = 1e-3}}, engine);
  const PointingError same({.jitter_sigma_x_rad = 1e-3}, 1);
  for (std::size_t i = 0; i < 100; ++i) {
    const Vector3d n = same.rotation(static_cast<std::int64_t>(i)).m.col(2);
    const Vector3d hit = lander(i) + lander(i).z() / n.z() * Vector3d(n.x(), -n.y(), -n.z());
    EXPECT_LT((true_point(batch, i) - hit).norm(), 1e-12);
    EXPECT_NE(true_point(batch, i).y(), lander(i).y());
    EXPECT_NEAR(estimated_point(batch, i).y(), lander(i).y(), 1e-12);
    EXPECT_EQ(batch.pulses.py_est[i], batch.pulses.py_true[i]);
  }
}

// Eq. 4: truth - estimate = -v e.
TEST(ErrorEffects, ATimeStampThatIsLateMovesTheEstimateAhead) {
  const PlaneEngine engine;
  constexpr double kLate_s = 0.002;
  const PulseBatch batch = simulate({.pointing = {.time_stamp_bias_s = kLate_s}}, engine);
  for (const std::size_t i : {0U, 50U, 99U}) {
    EXPECT_LT((true_point(batch, i) - estimated_point(batch, i) + kLate_s * kVelocity_mps).norm(), 1e-12);
    EXPECT_NEAR(batch.pulses.pz_est[i], lander(i, kLate_s).z(), 1e-12);
    EXPECT_EQ(batch.pulses.pz_true[i], lander(i).z());
  }
}

TEST(ErrorEffects, TimeStampsReachBeforeTheFirstPulseOfAMotionWithoutBeginning) {
  const PlaneEngine engine;
  const PulseBatch batch = simulate({.pointing = {.time_stamp_bias_s = -0.0025}}, engine);
  for (const std::size_t k : {0U, 2U, 10U})
    EXPECT_NEAR(batch.pulses.pz_est[k], lander(k, -0.0025).z(), 1e-12);
}

TEST(ErrorEffects, NavigationErrorsAreThoseOfTheStampedTime) {
  const PlaneEngine engine;
  ScanModel model = scan({.pointing = {.time_stamp_bias_s = 0.01}}, {0, 0, 0});
  model.navigation_error =
      std::make_unique<LinearNavigationError>(NavigationErrorParameters{.velocity_mps = {{10, 0, 0}}});
  EXPECT_NEAR(simulate(std::move(model), engine).pulses.px_est[0], -0.1, 1e-15);
}

std::unique_ptr<TableTrajectory> table(double first_s, double last_s) {
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  return std::make_unique<TableTrajectory>(
      std::vector<TrajectorySample>{{first_s, {{1, 2, 503}}, level}, {last_s, {{1, 2, 403}}, level}},
      "estimates");
}

TEST(ErrorEffects, TimeStampsStayWithinATable) {
  const PlaneEngine engine;
  ScanModel model = scan({.pointing = {.time_stamp_bias_s = -0.0025}});
  model.trajectory = table(0, 1);  // from 503 m, down by 100 m/s
  const PulseBatch batch = simulate(std::move(model), engine);
  EXPECT_EQ(batch.pulses.pz_est[0], 503);
  const auto last = batch.pulses.size() - 1;
  EXPECT_NEAR(batch.pulses.pz_est[last], batch.pulses.pz_true[last] + 0.25, 1e-12);
}

TEST(ErrorEffects, ATableOfEstimatesIsTheEstimate) {
  const PlaneEngine engine;
  ScanModel model = scan({});
  model.estimate = table(0, 1);
  const PulseBatch batch = simulate(std::move(model), engine);
  EXPECT_NEAR(batch.pulses.px_est[99], 1, 1e-12);
  EXPECT_NEAR(batch.pulses.pz_est[99], 503 - 100 * 0.099, 1e-10);
  EXPECT_EQ(batch.pulses.pz_true[99], lander(99).z());
}

/// Moves, on any clock, from x = t - first at `first_s` on.
std::unique_ptr<TableTrajectory> moving_from(double first_s, double epoch_s) {
  const auto row = [&](double t) {
    return TrajectorySample{epoch_s + t, {{std::sin(t), t, 503}}, Eigen::Quaterniond::Identity()};
  };
  return std::make_unique<TableTrajectory>(
      std::vector<TrajectorySample>{row(first_s), row(0.5), row(0.75), row(2)}, "on a clock");
}

// Truth, estimates that begin 0.5 s earlier, and time-stamp errors: the clock changes only the column t.
TEST(ErrorEffects, AClockDoesNotChangeTheScan) {
  const PlaneEngine engine;
  const auto made = [&](double epoch_s) {
    ScanModel model = scan({.pointing = {.time_stamp_bias_s = -0.0025}});
    model.trajectory = moving_from(0, epoch_s);
    model.estimate = moving_from(-0.5, epoch_s);
    return simulate(std::move(model), engine);
  };
  PulseBatch gps = made(1.4e9);
  const PulseBatch plain = made(0);
  EXPECT_EQ(gps.points, plain.points);
  EXPECT_EQ(gps.pulses.px_est, plain.pulses.px_est);
  EXPECT_EQ(gps.pulses.t[99], 1.4e9 + plain.pulses.t[99]);
  EXPECT_NEAR(plain.pulses.py_est[99], 0.099 - 0.0025, 0.01);
}

TEST(ErrorEffects, EstimatesMustReachOverTheScan) {
  const PlaneEngine engine;
  for (const auto& [first_s, last_s] : {std::pair(0.01, 1.0), std::pair(-1.0, 0.05)}) {
    ScanModel model = scan({});
    model.estimate = table(first_s, last_s);
    EXPECT_THAT([&] { Simulation(std::move(model), &engine); },
                testing::ThrowsMessage<FormatError>(testing::HasSubstr("estimates: time")));
  }
}

RangeErrorParameters false_in(double min_m, double max_m) {
  return {.false_return_frac = 1, .false_min_m = min_m, .false_max_m = max_m};
}

TEST(ErrorEffects, AFalseReturnBeforeTheEchoIsReported) {
  const PlaneEngine engine;
  const PulseBatch batch = simulate({.range = false_in(100, 200)}, engine);
  for (std::size_t i = 0; i < 100; ++i) {
    ASSERT_EQ(batch.points.status[i], false_return);
    const double measured = batch.points.range_measured[i];
    EXPECT_TRUE(measured >= 100 && measured < 200);
    EXPECT_EQ(batch.points.range_true[i], lander(i).z());
    EXPECT_LT((true_point(batch, i) - Vector3d(lander(i).x(), lander(i).y(), 0)).norm(), 1e-12);
    EXPECT_LT((estimated_point(batch, i) - (lander(i) - Vector3d(0, 0, measured))).norm(), 1e-12);
  }
}

TEST(ErrorEffects, AFalseReturnAfterTheEchoIsNot) {
  const PlaneEngine engine;
  const PulseBatch batch = simulate({.range = false_in(600, 700)}, engine);
  EXPECT_EQ(batch.status_counts()[0], 100);
  EXPECT_EQ(batch.points.range_measured, batch.points.range_true);
}

// Without an echo any false detection is reported; where nothing was hit the truth is put on the true beam.
TEST(ErrorEffects, AFalseReturnStandsForAMissOrADropout) {
  const PlaneEngine terrain;
  const PlaneEngine sky({.z0_m = 1000});
  RangeErrorParameters errors = false_in(600, 700);
  PulseBatch missed = simulate({.range = errors, .pointing = {.misalignment = {0.1, 0, 0}}}, sky);
  errors.dropout_frac = 1;
  const PulseBatch dropped = simulate({.range = errors}, terrain);
  for (std::size_t i = 0; i < 100; ++i) {
    ASSERT_EQ(missed.points.status[i], false_return);
    EXPECT_TRUE(std::isnan(missed.points.range_true[i]));
    const double r = missed.points.range_measured[i];
    EXPECT_LT((true_point(missed, i) - lander(i) - r * Vector3d(0, std::sin(0.1), -std::cos(0.1))).norm(),
              1e-12);
    ASSERT_EQ(dropped.points.status[i], false_return);
    EXPECT_EQ(dropped.points.range_true[i], lander(i).z());
    EXPECT_NEAR(true_point(dropped, i).z(), 0, 1e-12);
  }
  missed.keep_returns();
  EXPECT_EQ(missed.points.size(), 100U);
}

TEST(ErrorEffects, DeadPixelsGiveNoFalseReturns) {
  const PlaneEngine engine;
  RangeErrorParameters errors = false_in(100, 200);
  errors.dead_pixel_frac = 1;
  EXPECT_EQ(simulate({.range = errors}, engine).status_counts()[3], 100);
}

// A plane that rises by 0.75 in x, seen from above: tan(incidence) = 0.75.
TEST(ErrorEffects, NoiseFollowsTheIncidenceOnTheTrueSurface) {
  const PlaneEngine engine({0, 0.75, 0});
  const TriangulatedGrid terrain(
      grid_of(GridSpec::centered(2, 0.5), [](double x, double) { return 0.75 * x; }));
  const PulseBatch one = simulate({.range = {.range_sigma_m = 1}}, engine);
  const PulseBatch batch = simulate({.range = {.incidence_sigma_rad = 1e-3}}, engine, &terrain);
  for (std::size_t i = 0; i < 100; ++i) {
    const double v = one.points.range_measured[i] - one.points.range_true[i];
    const double r = batch.points.range_true[i];
    EXPECT_NEAR(batch.points.range_measured[i] - r, 1e-3 * r * 0.75 * v, 1e-12);
  }
}

TEST(ErrorEffects, IncidenceNeedsTheSurface) {
  const PlaneEngine engine;
  EXPECT_THAT([&] { Simulation(scan({.range = {.incidence_sigma_rad = 1e-3}}), &engine); },
              testing::ThrowsMessage<UsageError>(testing::HasSubstr("incidence_sigma_rad")));
}

}  // namespace
}  // namespace landfall
