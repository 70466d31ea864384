// SPDX-License-Identifier: GPL-3.0-or-later
// Errors of the mirror's clock in closed form, and for every scanner.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "analytic_engines.h"
#include "base/core/error.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/gimbal.h"
#include "chain/lidar/scanner/palmer.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/scanner/polygon.h"
#include "chain/lidar/scanner/risley.h"
#include "chain/lidar/scanner/table_scanner.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/lidar/trajectory/trajectories.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

constexpr double kAltitude_m = 500;
constexpr double kRate_hz = 20000;
constexpr int kColumns = 200;
constexpr double kHalfWidth_m = 50;
/// The speed of the footprint along a line: 10 km/s.
constexpr double kSweep_mps = 2 * kHalfWidth_m / (kColumns - 1) * kRate_hz;

std::unique_ptr<Pattern> lines(LineDirection direction = LineDirection::boustrophedon,
                               AtEnd at_end = AtEnd::wrap) {
  return std::make_unique<LineSearch>(LineSearchParameters{.rows = 3,
                                                           .columns = kColumns,
                                                           .half_width_m = kHalfWidth_m,
                                                           .direction = direction,
                                                           .at_end = at_end});
}

ScanModel scan(const PointingErrorParameters& errors, std::unique_ptr<const Scanner> scanner,
               std::unique_ptr<const Pattern> pattern, double scan_time_s = 0.03) {
  return ScanModel{.lidar = {.detector = perspective_detector({.rows = 1, .columns = 1}),
                             .scanner = std::move(scanner),
                             .pattern = std::move(pattern),
                             .range_errors = RangeErrors({}, 1),
                             .pointing_error = PointingError(errors, 1)},
                   .trajectory = std::make_unique<ConstantVelocity>(ConstantVelocityParameters{
                       .position_m = {{0, 0, kAltitude_m}}, .velocity_mps = {{0, 0, 0}}}),
                   .pulse_rate_hz = kRate_hz,
                   .scan_time_s = scan_time_s};
}

PulseBatch simulate(ScanModel model) {
  const PlaneEngine engine;
  const Simulation simulation(std::move(model), &engine);
  return simulation.simulate({0, simulation.pulse_count()});
}

PulseBatch paper_fsm(const PointingErrorParameters& errors) {
  return simulate(scan(errors, std::make_unique<Fsm>(FsmParameters{}), lines()));
}

/// +1 where the beam sweeps towards +x.
double direction_of(std::size_t pulse) { return pulse / kColumns % 2 == 0 ? 1 : -1; }

// The ground moves under the boresight at 10 km/s, so 10 us are 0.1 m; the sign alternates from line to line.
TEST(MirrorTime, TenMicrosecondsAreTenCentimetresAtTenKilometresPerSecond) {
  for (const double error_s : {10e-6, -10e-6}) {
    const PulseBatch batch = paper_fsm({.mirror_time_bias_s = error_s});
    const PulseBatch ideal = paper_fsm({});
    ASSERT_EQ(batch.points.size(), 600U);
    for (std::size_t k = 0; k < batch.points.size(); ++k) {
      const double ahead_m = batch.points.x_true[k] - ideal.points.x_true[k];
      ASSERT_NEAR(ahead_m, direction_of(k) * kSweep_mps * error_s, 1e-9) << "pulse " << k;
      ASSERT_NEAR(std::abs(ahead_m), 0.1005, 1e-4);
      ASSERT_NEAR(batch.points.y_true[k], ideal.points.y_true[k], 1e-9);
    }
  }
}

// The estimate uses the range of the true beam along the beam of the mirror at the pulse.
TEST(MirrorTime, TheEstimateUsesTheMirrorAtThePulse) {
  const PulseBatch batch = paper_fsm({.mirror_time_bias_s = 10e-6});
  const PulseBatch ideal = paper_fsm({});
  for (std::size_t k = 0; k < batch.points.size(); ++k) {
    const Vector3d aim(ideal.points.x_true[k], ideal.points.y_true[k], -kAltitude_m);
    const Vector3d hit(batch.points.x_true[k], batch.points.y_true[k], -kAltitude_m);
    const Vector3d point = hit.norm() * aim.normalized() + Vector3d(0, 0, kAltitude_m);
    const Vector3d estimate(batch.points.x_est[k], batch.points.y_est[k], batch.points.z_est[k]);
    ASSERT_LT((estimate - point).norm(), 1e-9);
    ASSERT_EQ(batch.pulses.px_est[k], batch.pulses.px_true[k]);
  }
}

// Whole pulse intervals: the true mirror at pulse k is that of an ideal scan at pulse k + 3.
TEST(MirrorTime, EveryScannerIsWhereItShouldBeThreePulsesLater) {
  struct Case {
    std::function<std::unique_ptr<const Scanner>()> scanner;
    bool follows = false;
  };
  const std::vector<AngleSample> table = {{-1, {-0.3, 0.2}}, {0.001, {0, 0.05}}, {1, {0.3, -0.2}}};
  const Case cases[] = {
      {[] { return std::make_unique<Fsm>(FsmParameters{.incidence_rad = 0.5}); }, true},
      {[] { return std::make_unique<Gimbal>(GimbalParameters{}); }, true},
      {[] {
         const RisleyPrism prism{1.5, 0.2, 0.01};
         return std::make_unique<Risley>(
             RisleyParameters{.optics = {.prisms = {prism, prism}}, .drive = RisleyBranch::positive});
       },
       true},
      {[] { return std::make_unique<Risley>(RisleyParameters{.encoder_sigma_rad = 0}); }},
      {[] {
        return std::make_unique<PolygonScanner>(
            PolygonParameters{.phase_rad = 0.01, .frame_amplitude_rad = 0.1});
      }},
      {[] { return std::make_unique<Palmer>(PalmerParameters{.tilt_rad = 0.04}); }},
      {[&] { return std::make_unique<TableScanner>(table, TableMirror{}); }},
      {[&] { return std::make_unique<TableScanner>(table, std::nullopt); }},
  };
  for (const Case& c : cases)
    for (const int shift : {3, -3}) {
      const auto run = [&](double error_s) {
        return simulate(scan({.mirror_time_bias_s = error_s}, c.scanner(), c.follows ? lines() : nullptr));
      };
      const PulseBatch late = run(shift / kRate_hz * (1 + 1e-12));
      const PulseBatch ideal = run(0);
      for (std::size_t k = 3; k + 3 < late.pulses.size(); ++k) {
        const auto other = static_cast<std::size_t>(static_cast<int>(k) + shift);
        for (const auto angle : {&PulseColumns::angle_1, &PulseColumns::angle_2}) {
          const double difference = (late.pulses.*angle)[k] - (ideal.pulses.*angle)[other];
          ASSERT_NEAR(std::remainder(difference, 2 * std::numbers::pi), 0, 1e-9) << k;
        }
        if (late.points.status[k] != PointStatus::returned) continue;
        EXPECT_NE(late.points.x_est[k], late.points.x_true[k]);
      }
    }
}

// A curved path is interpolated linearly between the aims of two pulses.
TEST(MirrorTime, BetweenTwoPulsesTheAimMovesUniformly) {
  const auto run = [](double error_s) {
    return simulate(scan(
        {.mirror_time_bias_s = error_s}, std::make_unique<Fsm>(FsmParameters{}),
        std::make_unique<Spiral>(SpiralParameters{.radius_m = 40, .inner_radius_m = 10, .period_s = 0.01})));
  };
  const PulseBatch ideal = run(0);
  for (const double share : {0.25, -0.25}) {
    const PulseBatch late = run(share / kRate_hz);
    for (std::size_t k = 1; k + 1 < late.points.size(); ++k) {
      const std::size_t other = share > 0 ? k + 1 : k - 1;
      ASSERT_NEAR(late.points.x_true[k], 0.75 * ideal.points.x_true[k] + 0.25 * ideal.points.x_true[other],
                  1e-9);
      ASSERT_NEAR(late.points.y_true[k], 0.75 * ideal.points.y_true[k] + 0.25 * ideal.points.y_true[other],
                  1e-9);
    }
  }
}

TEST(MirrorTime, WithoutAnAimAtThatTimeThereIsNoError) {
  const auto run = [](double error_s, std::unique_ptr<const Pattern> pattern) {
    return simulate(
        scan({.mirror_time_bias_s = error_s}, std::make_unique<Fsm>(FsmParameters{}), std::move(pattern)));
  };
  const PulseBatch early = run(-1.5 / kRate_hz, lines());
  EXPECT_NEAR(early.points.x_true[0], -kHalfWidth_m, 1e-9);
  const PulseBatch late = run(1.5 / kRate_hz, lines(LineDirection::unidirectional, AtEnd::stop));
  EXPECT_EQ(late.points.size(), 600U);
  EXPECT_NEAR(late.points.x_true[599], kHalfWidth_m, 1e-9);
  const PulseBatch still = run(1e-5, std::make_unique<Stare>(StareParameters{.aim_m = {3, 4}}));
  EXPECT_NEAR(still.points.x_true[5], 3, 1e-9);
}

// At a mosaic whose steps last one pulse nothing is known of the motion.
TEST(MirrorTime, AStepOfOnePulseDoesNotMove) {
  const auto one_column =
      std::make_unique<LineSearch>(LineSearchParameters{.rows = 5, .columns = 1, .half_width_m = 50});
  for (const double error_s : {1e-5, -1e-5}) {
    const PulseBatch batch =
        simulate(scan({.mirror_time_bias_s = error_s}, std::make_unique<Fsm>(FsmParameters{}),
                      std::make_unique<LineSearch>(*one_column)));
    EXPECT_NEAR(batch.points.y_true[1], 25, 1e-9);
  }
}

TEST(MirrorTime, TheLaserKeepsItsOwnTime) {
  const auto run = [](double error_s) {
    return simulate(scan({.mirror_time_bias_s = error_s},
                         std::make_unique<Fsm>(FsmParameters{.timing = {.turnaround_time_s = 0.001}}),
                         lines()));
  };
  const PulseBatch late = run(1e-4);
  EXPECT_EQ(late.points.status, run(0).points.status);
  EXPECT_EQ(late.points.status[219], PointStatus::blanked);
  EXPECT_EQ(late.points.status[220], PointStatus::returned);
  const auto polygon = [](double error_s) {
    return simulate(scan({.mirror_time_bias_s = error_s},
                         std::make_unique<PolygonScanner>(PolygonParameters{}), nullptr));
  };
  EXPECT_EQ(polygon(1e-4).points.status, polygon(0).points.status);
}

// tof_lag: the mirror at the echo is that of t + e + 2 r/c.
TEST(MirrorTime, AddsToTheTimeOfFlight) {
  const double flight_s = 2 * kAltitude_m / 299792458.0;
  for (const double error_s : {2e-6, -2e-6, -10e-6}) {
    const PulseBatch batch = simulate(scan({.mirror_time_bias_s = error_s},
                                           std::make_unique<Fsm>(FsmParameters{.tof_lag = true}), lines()));
    const PulseBatch ideal = paper_fsm({});
    for (const std::size_t k : {100U, 300U})  // below the lander, where r = 500 m
      EXPECT_NEAR(batch.points.x_true[k] - ideal.points.x_true[k],
                  direction_of(k) * kSweep_mps * (error_s + flight_s), 1e-3 * kSweep_mps * flight_s + 3e-4);
  }
}

TEST(MirrorTime, ATableMustCoverIt) {
  const std::vector<AngleSample> table = {{0, {}}, {0.02995, {0.01, 0}}};
  const auto run = [&](double error_s) {
    return simulate(
        scan({.mirror_time_bias_s = error_s}, std::make_unique<TableScanner>(table, TableMirror{}), nullptr));
  };
  EXPECT_NO_THROW(run(0));
  EXPECT_THROW(run(1e-5), FormatError);
  EXPECT_THROW(run(-1e-5), FormatError);
}

}  // namespace
}  // namespace landfall
