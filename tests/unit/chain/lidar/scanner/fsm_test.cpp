// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/core/error.h"
#include "base/numerics/random.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/mechanism.h"
#include "refusal.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

ScannerState aimed(const Fsm& fsm, const Direction<LidarFrame>& aim) { return fsm.state({.aim = aim}); }

Vector3d steered(const Fsm& fsm, const ScannerState& state, const Vector3d& pixel) {
  const Beam beam = beam_of(fsm, state, pixel);
  EXPECT_EQ(beam.exit, Point<LidarFrame>{});
  EXPECT_FALSE(beam.lost);
  return beam.direction.v;
}

TEST(Fsm, RestsWithoutAnAim) {
  const Fsm fsm({.incidence_rad = 45 * kDegree});
  const ScannerState state = fsm.state({});
  EXPECT_EQ(state.angle_1_rad, 0);
  EXPECT_EQ(state.angle_2_rad, 0);
  EXPECT_FALSE(state.blanked);
  for (const Vector3d& pixel : {Vector3d(0, 0, 1), Vector3d(0.6, 0, 0.8), Vector3d(0, -0.6, 0.8)})
    EXPECT_LT((steered(fsm, state, pixel) - pixel).norm(), 1e-15);
}

// i = 45 deg: the boresight comes in along (0, -1, 0) and the resting normal halves the right angle.
TEST(Fsm, FoldedMirrorRestsAt45Degrees) {
  const Fsm fsm({.incidence_rad = 45 * kDegree});
  EXPECT_LT((fsm.state({}).mirror_normal.v - Vector3d(0, 1, 1) / std::numbers::sqrt2).norm(), 2e-16);
}

TEST(Fsm, FoldAzimuthTurnsThePlaneOfIncidence) {
  const Fsm fsm({.incidence_rad = 45 * kDegree, .fold_azimuth_rad = kPi / 2});
  EXPECT_LT((fsm.state({}).mirror_normal.v - Vector3d(-1, 0, 1) / std::numbers::sqrt2).norm(), 2e-16);
}

TEST(Fsm, AimIsExact) {
  const RandomField random(1, RandomStream::fractal);
  for (const double incidence : {0.0, 5.0, 15.0, 30.0, 45.0, 60.0})
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const Fsm fsm({.incidence_rad = incidence * kDegree, .fold_azimuth_rad = 7 * random.uniform(i, 0)});
      const auto aim = towards(30 * kDegree * random.uniform(i, 1), 2 * kPi * random.uniform(i, 2));
      ASSERT_LE((steered(fsm, aimed(fsm, aim), Vector3d::UnitZ()) - aim.v).cwiseAbs().maxCoeff(), 1e-15)
          << "incidence " << incidence << " deg, draw " << i;
    }
}

// Two reflections are a rotation: angles between pixels stay.
TEST(Fsm, KeepsTheImageRigid) {
  const Fsm fsm({.incidence_rad = 30 * kDegree, .fold_azimuth_rad = 1});
  const ScannerState state = aimed(fsm, towards(0.4, 2));
  const Vector3d x = steered(fsm, state, Vector3d::UnitX());
  const Vector3d y = steered(fsm, state, Vector3d::UnitY());
  const Vector3d z = steered(fsm, state, Vector3d::UnitZ());
  EXPECT_LT((x.cross(y) - z).norm(), 1e-15);
  EXPECT_NEAR(x.dot(y), 0, 1e-15);
}

// m = R(e1, angle_1) R(e2, angle_2) m0.
TEST(Fsm, AnglesGiveTheMirrorBack) {
  const double incidence = 0.6;
  const double azimuth = 1.1;
  const Fsm fsm({.incidence_rad = incidence, .fold_azimuth_rad = azimuth});
  const Vector3d e1(std::cos(azimuth), std::sin(azimuth), 0);
  const Vector3d m0 =
      Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) * Vector3d(0, std::sin(incidence), std::cos(incidence));
  const Vector3d e2 = m0.cross(e1);
  for (double turn = 0; turn < 2 * kPi; turn += 0.3) {
    const ScannerState state = aimed(fsm, towards(0.35, turn));
    const Vector3d m =
        Eigen::AngleAxisd(state.angle_1_rad, e1) * (Eigen::AngleAxisd(state.angle_2_rad, e2) * m0);
    EXPECT_LT((m - state.mirror_normal.v).norm(), 1e-15);
  }
}

// A positive angle_1 tips the normal from +z towards -y, a positive angle_2 towards +x.
TEST(Fsm, SmallSignalGains) {
  constexpr double kPsi = 1e-4;
  for (const double incidence : {0.0, 5.0, 15.0, 30.0, 45.0}) {
    const Fsm fsm({.incidence_rad = incidence * kDegree});
    const ScannerState in_plane = aimed(fsm, towards(kPsi, -kPi / 2));
    EXPECT_NEAR(kPsi / in_plane.angle_1_rad, 2, 1e-9);
    EXPECT_NEAR(in_plane.angle_2_rad, 0, 1e-15);
    const ScannerState across = aimed(fsm, towards(kPsi, 0));
    EXPECT_NEAR(kPsi / across.angle_2_rad, 2 * std::cos(incidence * kDegree), 1e-7);
    EXPECT_NEAR(across.angle_1_rad, 0, kPsi * kPsi);
  }
}

// Towards +x the image turns by -psi tan i about the line of sight (counter-clockwise on the map at the
// nominal mount); the next term is of third order.
TEST(Fsm, ImageTurnsByPsiTanIncidence) {
  for (const double incidence : {5.0, 15.0, 30.0, 45.0}) {
    const Fsm fsm({.incidence_rad = incidence * kDegree});
    const double tan_i = std::tan(incidence * kDegree);
    for (const double psi : {0.001, 0.01, 0.1}) {
      EXPECT_NEAR(image_rotation(fsm, aimed(fsm, towards(psi, 0))), -psi * tan_i, psi * psi * psi);
      EXPECT_NEAR(image_rotation(fsm, aimed(fsm, towards(psi, kPi))), psi * tan_i, psi * psi * psi);
    }
    EXPECT_NEAR(image_rotation(fsm, aimed(fsm, towards(0.1, kPi / 2))), 0, 1e-15)
        << "in-plane motion turns nothing";
  }
}

TEST(Fsm, ImageDoesNotTurnAtNormalIncidence) {
  const Fsm fsm({});
  for (double turn = 0; turn < 2 * kPi; turn += 0.3)
    EXPECT_NEAR(image_rotation(fsm, aimed(fsm, towards(0.3, turn))), 0, 1e-15);
}

TEST(Fsm, RefusesAnAimBeyondItsReach) {
  const Fsm fsm({.max_deflection_rad = 0.2});
  EXPECT_NO_THROW(static_cast<void>(aimed(fsm, towards(0.1999999, 1))));
  EXPECT_THROW(static_cast<void>(aimed(fsm, {{0, 0, -1}})), FormatError);
  EXPECT_THROW(static_cast<void>(aimed(fsm, {{std::nan(""), 0, 1}})), FormatError);
  EXPECT_THAT(refusal<FormatError>([&] {
                return fsm.state({.time = {17, 0}, .aim = towards(20 * kDegree, 1)});
              }),
              testing::AllOf(testing::HasSubstr("pulse 17 aims 20 degrees"),
                             testing::HasSubstr("max_deflection_deg allows 11.4592")));
}

TEST(Fsm, ReachesThirtyDegreesByDefault) {
  const Fsm fsm({});
  EXPECT_NO_THROW(static_cast<void>(aimed(fsm, towards(29.999 * kDegree, 0))));
  EXPECT_THROW(static_cast<void>(aimed(fsm, towards(30.001 * kDegree, 0))), FormatError);
}

TEST(Fsm, RefusesParametersOutOfRange) {
  EXPECT_THROW(Fsm({.incidence_rad = -0.1}), UsageError);
  EXPECT_THROW(Fsm({.incidence_rad = kPi / 2}), UsageError);
  EXPECT_THROW(Fsm({.incidence_rad = std::nan("")}), UsageError);
  EXPECT_THROW(Fsm({.fold_azimuth_rad = HUGE_VAL}), UsageError);
  EXPECT_THROW(Fsm({.max_deflection_rad = 0}), UsageError);
  EXPECT_THROW(Fsm({.incidence_rad = 80 * kDegree, .max_deflection_rad = 20.001 * kDegree}), UsageError);
  EXPECT_NO_THROW(Fsm({.incidence_rad = 80 * kDegree, .max_deflection_rad = 19.999 * kDegree}));
}

constexpr double kNever = std::numeric_limits<double>::infinity();

TEST(MechanismTiming, DefaultFollowsAtOnce) {
  const MechanismTiming timing({});
  for (const double t : {0.0, 1e-6, 1.0, kNever}) {
    EXPECT_FALSE(timing.blanks(t));
    EXPECT_EQ(timing.step_left(t), 0);
  }
}

// 20 kHz, 1 ms: twenty pulses. The times are quotients such as 220/20000 - 200/20000, just below 1 ms.
TEST(MechanismTiming, BlanksTheTimeTimesTheRate) {
  const MechanismTiming timing({.turnaround_time_s = 1e-3});
  for (int line = 0; line < 200; ++line) {
    int blanked = 0;
    for (int k = 0; k < 200; ++k)
      if (timing.blanks((200 * line + k) / 20000.0 - 200 * line / 20000.0)) ++blanked;
    EXPECT_EQ(blanked, 20) << "line " << line;
  }
  EXPECT_FALSE(timing.blanks(kNever));
}

// Against the differential equation x'' + 2 zeta w x' + w^2 x = 0, x(0) = 1, x'(0) = 0, by small steps.
TEST(MechanismTiming, StepSolvesTheOscillator) {
  RandomCases random;
  for (int i = 0; i < 20; ++i) {
    const double zeta = random.uniform(0.2, 0.95);
    const double settle_s = random.uniform(1e-4, 1e-2);
    const MechanismTiming timing({.settle_time_s = settle_s, .settle_damping = zeta});
    const double w = 3 / (zeta * settle_s);
    constexpr int kSteps = 50000;
    const double h = 2 * settle_s / kSteps;
    double x = 1;
    double v = 0;
    for (int k = 1; k <= kSteps; ++k) {
      // The midpoint rule; its error over the run is far below the tolerance.
      const double x_mid = x + h / 2 * v;
      const double v_mid = v - h / 2 * (2 * zeta * w * v + w * w * x);
      x += h * v_mid;
      v -= h * (2 * zeta * w * v_mid + w * w * x_mid);
      if (k % 1000 == 0) {
        ASSERT_NEAR(timing.step_left(k * h), x, 2e-5) << "zeta " << zeta;
      }
    }
  }
}

TEST(MechanismTiming, SettlesWithinItsEnvelope) {
  for (const double zeta : {0.1, 0.4, 0.7, 0.9}) {
    const MechanismTiming timing({.settle_time_s = 2e-3, .settle_damping = zeta});
    const double envelope = std::exp(-3.0) / std::sqrt(1 - zeta * zeta);
    EXPECT_EQ(timing.step_left(0), 1);
    for (double t = 2e-3; t < 6e-3; t += 1e-5) EXPECT_LE(std::abs(timing.step_left(t)), envelope);
    EXPECT_EQ(timing.step_left(0.1), 0);
    EXPECT_EQ(timing.step_left(kNever), 0);
  }
}

TEST(MechanismTiming, RefusesParametersOutOfRange) {
  EXPECT_THROW(MechanismTiming({.turnaround_time_s = -1e-9}), UsageError);
  EXPECT_THROW(MechanismTiming({.turnaround_time_s = HUGE_VAL}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_time_s = -1e-9}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_time_s = std::nan("")}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_damping = 0}), UsageError);
  EXPECT_THROW(MechanismTiming({.settle_damping = 1}), UsageError);
}

// By hand: from rest, half of the way is s/2 = a (T/2)^2/2; a mirror that passes its aim at u brakes for u/a,
// has then gone u^2/2a too far, and returns from rest.
TEST(TransferTime, ClosedForms) {
  for (const double a : {1.0, 2e4}) {
    for (const double s : {0.1, -0.1, 1e-6})
      EXPECT_NEAR(transfer_time_s(s, 0, a), 2 * std::sqrt(std::abs(s) / a), 1e-15);
    for (const double u : {0.3, -0.3})
      EXPECT_NEAR(transfer_time_s(0, u, a), std::abs(u) / a + 2 * std::sqrt(u * u / (2 * a) / a), 1e-15);
    EXPECT_EQ(transfer_time_s(0, 0, a), 0);
    // The aim lies where braking ends.
    EXPECT_NEAR(transfer_time_s(0.5 * 0.3 * 0.3 / a, 0.3, a), 0.3 / a, 1e-12);
    EXPECT_NEAR(transfer_time_s(-0.5 * 0.3 * 0.3 / a, -0.3, a), 0.3 / a, 1e-12);
  }
  EXPECT_NEAR(transfer_time_s(6.28 * kDegree, 0, 2e4), 4.68e-3,
              1e-5);  // the example of docs/reference/lidar.md
}

// Property: T seconds of full acceleration and braking, switched once, end at the aim and at rest relative to
// it.
TEST(TransferTime, ReachesTheAim) {
  RandomCases random;
  for (int i = 0; i < 5000; ++i) {
    const double a = random.uniform(0.1, 10);
    const double ahead = random.uniform(-1, 1);
    const double u = random.uniform(-1, 1);
    const double total = transfer_time_s(ahead, u, a);
    ASSERT_GE(total, std::abs(u) / a - 1e-12);
    // With the first phase of t1 at +-a and the rest at -+a, the speed ends at 0: u +- a (2 t1 - T) = 0.
    double nearest = 1e9;
    for (const double sign : {1.0, -1.0}) {
      const double t1 = (total - sign * u / a) / 2;
      if (t1 < -1e-9 || t1 > total + 1e-9) continue;
      const double t2 = total - t1;
      const double middle = u + sign * a * t1;
      nearest = std::min(
          nearest, std::abs(u * t1 + sign * a * t1 * t1 / 2 + middle * t2 - sign * a * t2 * t2 / 2 - ahead));
    }
    ASSERT_NEAR(nearest, 0, 1e-9) << "a " << a << ", D " << ahead << ", u " << u;
  }
}

TEST(MechanismTiming, MovesUntilTheSlowerAxisIsThere) {
  const MechanismTiming timing({.max_acceleration_radps2 = 100});
  EXPECT_TRUE(timing.depends_on_jumps());
  const double h = 1e-3;
  // Both aims at rest, 0.01 and 0.0025 rad away: 20 ms and 10 ms after the last pulse before the jump.
  const AxesJump step{.before = {0, 0.0025}, .after = {0.01, 0}, .interval_s = h};
  EXPECT_TRUE(timing.is_moving(0.0189, step));
  EXPECT_FALSE(timing.is_moving(0.019, step));
  const AxesJump other{.before = {0, 0.01}, .after = {0.0025, 0}, .interval_s = h};
  EXPECT_TRUE(timing.is_moving(0.0189, other));
  EXPECT_FALSE(timing.is_moving(0.019, other));
  EXPECT_FALSE(MechanismTiming({}).is_moving(0, step));
  // Lines in one direction: with the motion of the lines, the flyback is one from rest to rest. The aim would
  // have been h w before the first pulse when the mirror left.
  const double w = 3;
  const AxesJump flyback{.before = {0.005, 0},
                         .rate_before = {w, 0},
                         .after = {-0.005 + h * w, 0},
                         .rate_after = {w, 0},
                         .interval_s = h};
  EXPECT_TRUE(timing.is_moving(0.0189, flyback));
  EXPECT_FALSE(timing.is_moving(0.019, flyback));
  // There and back: a mirror that turns about meets the line that left it at once.
  const AxesJump turn{.rate_before = {w, 0}, .after = {-h * w, 0}, .rate_after = {-w, 0}, .interval_s = h};
  const double needed_s = (1 + std::sqrt(2.0)) * 2 * w / 100;
  EXPECT_TRUE(timing.is_moving(needed_s - h - 1e-6, turn));
  EXPECT_FALSE(timing.is_moving(needed_s - h + 1e-6, turn));
}

}  // namespace
}  // namespace landfall
