// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "analytic_engines.h"
#include "base/core/error.h"
#include "base/core/parallel.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "points.h"
#include "refusal.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

/// The paper's scan with a detector of one row.
ScanModel fsm_scan(int columns, const LineSearchParameters& pattern = {},
                   const ConstantVelocityParameters& motion = {}, const RangeErrorParameters& errors = {}) {
  return ScanModel{.lidar = {.detector = perspective_detector({.rows = 1, .columns = columns}),
                             .scanner = std::make_unique<Fsm>(FsmParameters{}),
                             .pattern = std::make_unique<LineSearch>(pattern),
                             .range_errors = RangeErrors(errors, 1)},
                   .trajectory = std::make_unique<ConstantVelocity>(motion)};
}

ScanModel flash_scan(double pulse_rate_hz, double scan_time_s) {
  return ScanModel{.lidar = {.detector = perspective_detector({.rows = 1, .columns = 1}),
                             .scanner = std::make_unique<Flash>(),
                             .range_errors = RangeErrors({}, 1)},
                   .trajectory = std::make_unique<ConstantVelocity>(ConstantVelocityParameters{}),
                   .pulse_rate_hz = pulse_rate_hz,
                   .scan_time_s = scan_time_s};
}

Vector3d first_point(const Simulation& simulation, std::int64_t pulse) {
  return true_point(simulation.simulate({pulse, 1}), 0);
}

TEST(Simulation, ReferenceRasterMeetsItsAims) {
  const PlaneEngine engine;
  const Simulation simulation(fsm_scan(1), &engine);
  EXPECT_EQ(simulation.pulse_count(), 40000);
  EXPECT_LT((first_point(simulation, 0) - Vector3d(-50, 50, 0)).norm(), 1e-11);
  EXPECT_LT((first_point(simulation, 39999) - Vector3d(50, -50, 0)).norm(), 1e-11);
  const PulseBatch last = simulation.simulate({39999, 1});
  EXPECT_EQ(last.points.pulse[0], 39999);
  EXPECT_EQ(last.pulses.t[0], 39999 / 20000.0);
  EXPECT_NEAR(last.pulses.pz_true[0], 500 - 23 * 1.99995, 1e-12);
}

// The lander believes to be 2 m west of its place: it aims 2 m too far east, and measures the aimed point.
TEST(Simulation, AimFromTheEstimateMovesTheBeams) {
  const PlaneEngine engine;
  const auto scan = [&](bool aims_from_estimate) {
    ScanModel model = fsm_scan(1);
    model.navigation_error =
        std::make_unique<LinearNavigationError>(NavigationErrorParameters{.position_m = {{2, 0, 0}}});
    model.aims_from_estimate = aims_from_estimate;
    return Simulation(std::move(model), &engine).simulate({0, 1});
  };
  EXPECT_NEAR(scan(false).points.x_true[0], -50, 1e-11);
  EXPECT_NEAR(scan(false).points.x_est[0], -52, 1e-11);
  EXPECT_NEAR(scan(true).points.x_true[0], -48, 1e-11);
  EXPECT_NEAR(scan(true).points.x_est[0], -50, 1e-11);
}

// The pattern compensates for the planned path only.
TEST(Simulation, DispersionMovesTheBeamsAndTheEstimateFollows) {
  const PlaneEngine engine;
  ScanModel model = fsm_scan(1);
  model.trajectory = std::make_unique<DispersedTrajectory>(
      std::make_unique<ConstantVelocity>(ConstantVelocityParameters{}),
      DispersionParameters{.position_m = {{3, 0, 0}}, .velocity_mps = {{0, 1, 0}}});
  const Simulation simulation(std::move(model), &engine);
  EXPECT_LT((first_point(simulation, 0) - Vector3d(-47, 50, 0)).norm(), 1e-11);
  EXPECT_LT((first_point(simulation, 39999) - Vector3d(53, -50 + 1.99995, 0)).norm(), 1e-11);
  const PulseBatch last = simulation.simulate({39999, 1});
  EXPECT_EQ(last.pulses.py_est[0], 1.99995);
  EXPECT_EQ(last.points.x_est[0], last.points.x_true[0]);
}

// A compensated pattern meets the ground where it shall from any place and attitude, lever arm included.
TEST(Simulation, CompensatedPatternFollowsPositionAndAttitude) {
  const PlaneEngine engine;
  ScanModel model = fsm_scan(
      1, {},
      {.velocity_mps = {{3, -2, -23}}, .rpy = {0.02, -0.03, 1.2}, .rpy_rate_radps = {0.01, 0.02, -0.1}});
  model.lidar.mount.position.v = {1, 2, -0.5};
  const Simulation simulation(std::move(model), &engine);
  const LineSearch pattern({});
  for (const std::int64_t k : {0, 137, 20199, 39999})
    EXPECT_LT((first_point(simulation, k) - pattern.aim_point({k, 0})->v).norm(), 1e-10);
}

// From 500 m the uncompensated pattern aims at (50, -50); the same direction from p_z at the last pulse.
TEST(Simulation, UncompensatedPatternReplaysTheFirstPosesAngles) {
  const PlaneEngine engine;
  const Simulation simulation(fsm_scan(1, {.compensated = false}), &engine);
  EXPECT_LT((first_point(simulation, 0) - Vector3d(-50, 50, 0)).norm(), 1e-11);
  const double shrink = (500 - 23 * 1.99995) / 500;
  EXPECT_LT((first_point(simulation, 39999) - shrink * Vector3d(50, -50, 0)).norm(), 1e-11);
}

TEST(Simulation, NavigationErrorMovesOnlyTheEstimate) {
  const PlaneEngine engine;
  ScanModel wrong = fsm_scan(2);
  wrong.navigation_error = std::make_unique<LinearNavigationError>(
      NavigationErrorParameters{.position_m = {{1, 2, 3}}, .velocity_mps = {{0.3, 0.3, 0.7}}});
  const PulseBatch truth = Simulation(fsm_scan(2), &engine).simulate({39998, 2});
  const PulseBatch estimate = Simulation(std::move(wrong), &engine).simulate({39998, 2});
  EXPECT_EQ(estimate.points.x_true, truth.points.x_true);
  EXPECT_EQ(estimate.points.range_true, truth.points.range_true);
  EXPECT_EQ(estimate.pulses.angle_1, truth.pulses.angle_1);
  // Eq. 7 at the last pulse: the estimate lies lower by a_p + a_v t.
  const double t = 1.99995;
  EXPECT_NEAR(estimate.points.x_true[2] - estimate.points.x_est[2], 1 + 0.3 * t, 1e-11);
  EXPECT_NEAR(estimate.points.y_true[2] - estimate.points.y_est[2], 2 + 0.3 * t, 1e-11);
  EXPECT_NEAR(estimate.points.z_true[2] - estimate.points.z_est[2], 3 + 0.7 * t, 1e-11);
  EXPECT_NEAR(estimate.pulses.pz_true[1] - estimate.pulses.pz_est[1], 3 + 0.7 * t, 1e-11);
}

// A table that starts at 7 s: pulses at 7 + k/f, navigation errors from the first pulse on.
TEST(Simulation, TimeCountsFromTheTrajectorysStart) {
  const PlaneEngine engine;
  ScanModel model = flash_scan(10, 1);
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  model.trajectory = std::make_unique<TableTrajectory>(
      std::vector<TrajectorySample>{{7, {{0, 0, 500}}, level}, {9, {{2, 0, 454}}, level}});
  model.navigation_error =
      std::make_unique<LinearNavigationError>(NavigationErrorParameters{.velocity_mps = {{1, 0, 0}}});
  const PulseBatch batch = Simulation(std::move(model), &engine).simulate({0, 10});
  EXPECT_EQ(batch.pulses.t[0], 7);
  EXPECT_EQ(batch.pulses.t[5], 7.5);
  EXPECT_NEAR(batch.points.x_true[5], 0.5, 1e-12);
  EXPECT_NEAR(batch.points.x_est[0], 0, 1e-12);
  EXPECT_NEAR(batch.points.x_est[5], 0, 1e-12);
  EXPECT_NEAR(batch.points.range_true[5], 488.5, 1e-12);
}

TEST(Simulation, CountsPulses) {
  const PlaneEngine engine;
  const auto count = [&](double rate, double time) {
    return Simulation(flash_scan(rate, time), &engine).pulse_count();
  };
  EXPECT_EQ(count(20000, 2), 40000);
  EXPECT_EQ(count(100, 0.29), 29);  // 28.999999999999996 in doubles
  EXPECT_EQ(count(10, 0.19), 1);
  EXPECT_EQ(count(1, 1), 1);
}

TEST(Simulation, PatternMayStopTheScan) {
  const PlaneEngine engine;
  EXPECT_EQ(Simulation(fsm_scan(1, {.rows = 10, .columns = 7, .at_end = AtEnd::stop}), &engine).pulse_count(),
            70);
  EXPECT_EQ(Simulation(fsm_scan(1, {.rows = 300, .at_end = AtEnd::stop}), &engine).pulse_count(), 40000);
}

TEST(Simulation, PatternWrapsAround) {
  const PlaneEngine engine;
  const Simulation simulation(fsm_scan(1, {.rows = 10, .columns = 7}), &engine);
  EXPECT_EQ(simulation.pulse_count(), 40000);
  EXPECT_LT((first_point(simulation, 70) - Vector3d(-50, 50, 0)).norm(), 1e-11);
}

TEST(Simulation, RefusesAScanWithoutPulses) {
  const PlaneEngine engine;
  const auto refused = [&](double rate, double time) {
    EXPECT_THROW(Simulation(flash_scan(rate, time), &engine), UsageError);
  };
  refused(0, 2);
  refused(-1, -2);
  refused(std::nan(""), 2);
  refused(20000, 0);
  refused(20000, HUGE_VAL);
  refused(1, 0.5);
  refused(1e9, 10);
}

TEST(Simulation, RefusesATrajectoryThatEndsTooEarly) {
  const PlaneEngine engine;
  const auto with_table_until = [&](double end_s) {
    ScanModel model = flash_scan(10, 2);  // the last pulse at 1.9 s
    const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
    model.trajectory = std::make_unique<TableTrajectory>(
        std::vector<TrajectorySample>{{0, {{0, 0, 500}}, level}, {end_s, {{0, 0, 454}}, level}});
    return Simulation(std::move(model), &engine).pulse_count();
  };
  EXPECT_EQ(with_table_until(1.9), 20);
  EXPECT_THROW(with_table_until(1.89), FormatError);
}

const RangeErrorParameters kAllErrors{
    .range_sigma_m = 0.02, .range_bias_m = 0.01, .dead_pixel_frac = 0.1, .dropout_frac = 0.1};

/// Compared by bits, as NaN differs from itself.
void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i])) << "row " << i;
}

TEST(Simulation, BatchesAndThreadsChangeNothing) {
  const PlaneEngine engine({1, 0.1, -0.2});
  const Simulation simulation(fsm_scan(18, {.rows = 10, .columns = 10}, {}, kAllErrors), &engine);
  const PulseBatch whole = simulation.simulate({0, 200});
  for (const std::size_t size : {1U, 7U, 64U}) {
    PulseBatch joined;
    joined.resize(200, 18);
    parallel_for(200, size, [&](std::size_t begin, std::size_t end) {
      const PulseBatch part =
          simulation.simulate({static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end - begin)});
      std::copy(part.points.x_est.begin(), part.points.x_est.end(),
                joined.points.x_est.begin() + static_cast<std::ptrdiff_t>(begin * 18));
      std::copy(part.points.status.begin(), part.points.status.end(),
                joined.points.status.begin() + static_cast<std::ptrdiff_t>(begin * 18));
      std::copy(part.pulses.angle_1.begin(), part.pulses.angle_1.end(),
                joined.pulses.angle_1.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    expect_same_bits(joined.points.x_est, whole.points.x_est);
    expect_same_bits(joined.pulses.angle_1, whole.pulses.angle_1);
    EXPECT_EQ(joined.points.status, whole.points.status);
  }
}

TEST(Simulation, BatchMemoryCanBeUsedAgain) {
  const PlaneEngine engine;
  const Simulation simulation(fsm_scan(4), &engine);
  PulseBatch batch;
  simulation.simulate({0, 50}, batch);
  batch.keep_returns();
  simulation.simulate({100, 3}, batch);
  const PulseBatch fresh = simulation.simulate({100, 3});
  EXPECT_EQ(batch.points, fresh.points);
  EXPECT_EQ(batch.pulses, fresh.pulses);
}

// 18 x 10,000 draws; 5 standard errors: a correct generator fails one seed in 1.7 million per check.
TEST(Simulation, ErrorsHaveTheirStatistics) {
  const PlaneEngine engine;
  const Simulation simulation(
      fsm_scan(18, {}, {}, {.range_sigma_m = 0.02, .range_bias_m = 0.5, .dropout_frac = 0.1}), &engine);
  const PulseBatch batch = simulation.simulate({0, 10000});
  const auto counts = batch.status_counts();
  EXPECT_EQ(counts[0] + counts[2], 180000);
  EXPECT_NEAR(static_cast<double>(counts[2]) / 180000, 0.1, 5 * std::sqrt(0.09 / 180000));
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < batch.points.size(); ++i) {
    if (batch.points.status[i] != PointStatus::returned) continue;
    const double v = (batch.points.range_measured[i] - batch.points.range_true[i] - 0.5) / 0.02;
    sum += v;
    squares += v * v;
  }
  const auto n = static_cast<double>(counts[0]);
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2 / n));
}

TEST(Simulation, DeadPixelsAreDeadInEveryPulse) {
  const PlaneEngine engine;
  const Simulation simulation(fsm_scan(18, {}, {}, {.dead_pixel_frac = 0.3}), &engine);
  const PulseBatch batch = simulation.simulate({0, 20});
  std::size_t dead = 0;
  for (std::size_t i = 0; i < batch.points.size(); ++i) {
    const bool is_dead = batch.points.status[i] == PointStatus::dead;
    ASSERT_EQ(is_dead, simulation.dead_map()[i % 18] != 0);
    dead += is_dead ? 1 : 0;
  }
  EXPECT_GT(dead, 0U);
  EXPECT_LT(dead, batch.points.size());
}

TEST(Simulation, ReplayNeedsNoEngineAndGivesTheSameReturns) {
  const PlaneEngine engine;
  const Simulation traced(fsm_scan(18, {}, {}, kAllErrors), &engine);
  const Simulation blind(fsm_scan(18, {}, {}, kAllErrors), nullptr);
  const PulseBatch original = traced.simulate({100, 30});
  PulseBatch replayed;
  blind.replay({100, 30}, {original.points.range_true}, replayed);
  expect_same_bits(replayed.points.x_est, original.points.x_est);
  expect_same_bits(replayed.points.z_true, original.points.z_true);
  EXPECT_EQ(replayed.points.status, original.points.status);
  EXPECT_THROW(blind.replay({100, 29}, {original.points.range_true}, replayed), FormatError);
}

// The descent meets the ground at 500/23 = 21.74 s; with 1 pulse per second the 23rd is the first below it.
TEST(Simulation, NamesThePulseThatIsUnderground) {
  const PlaneEngine engine;
  const TriangulatedGrid terrain(Grid<double>(GridSpec::centered(1, 1)));
  const Simulation simulation(flash_scan(1, 30), &engine, &terrain);
  EXPECT_NO_THROW(static_cast<void>(simulation.simulate({0, 22})));
  EXPECT_THAT(refusal<FormatError>([&] {
                return simulation.simulate({0, 30});
              }),
              testing::AllOf(testing::HasSubstr("pulse 22"), testing::HasSubstr("-6 m high")));
}

/// Yawed by 0.3 rad where it was planned to be level, and 1 m off its planned place.
class Yawed : public ConstantVelocity {
 public:
  Yawed() : ConstantVelocity({.position_m = {{1, 0, 500}}, .rpy = {0, 0, 0.3}}) {}
  [[nodiscard]] Pose nominal_pose(double t_s) const override { return ConstantVelocity({}).pose(t_s); }
};

// The commanded attitude replaces the true one before the errors come on it; the place stays the true one.
TEST(Simulation, ALanderMayTakeItsCommandedAttitudeForTheTrueOne) {
  const PlaneEngine engine;
  for (const AttitudeKnowledge knowledge : {AttitudeKnowledge::truth, AttitudeKnowledge::commanded}) {
    ScanModel model = flash_scan(10, 1);
    model.trajectory = std::make_unique<Yawed>();
    model.navigation_error = std::make_unique<LinearNavigationError>(
        NavigationErrorParameters{.position_m = {{0.25, 0, 0}}, .rpy = {0, 0, 0.1}});
    model.attitude_knowledge = knowledge;
    const PulseBatch batch = Simulation(std::move(model), &engine).simulate({3, 1});
    const double known_rad = knowledge == AttitudeKnowledge::truth ? 0.3 : 0;
    EXPECT_NEAR(2 * std::asin(batch.pulses.qz_est[0]), known_rad + 0.1, 1e-15);
    EXPECT_NEAR(2 * std::asin(batch.pulses.qz_true[0]), 0.3, 1e-15);
    EXPECT_EQ(batch.pulses.px_est[0], 0.75);
  }
}

}  // namespace
}  // namespace landfall
