// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "chain/lidar/scanner/fsm.h"
#include "refusal.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;

// Seen behind the resting mirror the pixels diverge from a point focal_distance behind it, and leave the
// plane z = 0 of an unfolded mirror at f tan(angle).
TEST(FsmExit, RestingMirrorAtNormalIncidence) {
  const Fsm fsm({.focal_distance_m = 0.2});
  const Vector3d pixel = towards(0.1, 0.5).v;
  const Beam beam = beam_of(fsm, fsm.state({}), pixel);
  EXPECT_LT((beam.direction.v - pixel).norm(), 1e-15);
  EXPECT_LT((beam.exit.v - 0.2 * std::tan(0.1) * Vector3d(std::cos(0.5), std::sin(0.5), 0)).norm(), 1e-15);
}

// The mirror tips by theta about x, with its surface h above the pivot: the plane then cuts the boresight at
// z = h (1/cos theta - 1) above the origin, towards the camera.
TEST(FsmExit, PivotBehindTheSurface) {
  const double h = 0.01;
  const double theta = 0.1;
  const Fsm fsm({.pivot_m = {{0, 0, -h}}});
  const ScannerState state = fsm.state({.aim = towards(2 * theta, -kPi / 2)});
  EXPECT_NEAR(state.angle_1_rad, theta, 1e-15);
  const Vector3d exit = beam_of(fsm, state, Vector3d::UnitZ()).exit.v;
  EXPECT_LT((exit - Vector3d(0, 0, h * (1 / std::cos(theta) - 1))).norm(), 1e-15);
}

// A mirror that turns about a point of its own plane moves off the boresight like a door.
TEST(FsmExit, PivotBesideTheBoresight) {
  const double a = 0.02;
  const double theta = 0.1;
  const Fsm fsm({.pivot_m = {{0, a, 0}}});
  const ScannerState state = fsm.state({.aim = towards(2 * theta, -kPi / 2)});
  const Vector3d exit = beam_of(fsm, state, Vector3d::UnitZ()).exit.v;
  EXPECT_LT((exit - Vector3d(0, 0, -a * std::tan(theta))).norm(), 1e-15);
}

TEST(FsmExit, NothingMovesWithoutPivotAndFocalDistance) {
  const Fsm plain({.incidence_rad = 0.5});
  const Fsm on_axis({.incidence_rad = 0.5, .focal_distance_m = 0.3});
  const ScannerState state = plain.state({.aim = towards(0.2, 1)});
  EXPECT_EQ(beam_of(plain, state, towards(0.01, 2).v).exit.v, Vector3d::Zero());
  EXPECT_LT(beam_of(on_axis, state, Vector3d::UnitZ()).exit.v.norm(), 1e-16) << "the boresight's exit stays";
}

// Property: each ray starts at the focal point, meets the moved surface at b, and leaves by the law of
// reflection; the surface keeps its distance from the pivot. All against plain rotations of four points.
TEST(FsmExit, RaysMeetTheMovedMirror) {
  RandomCases random;
  for (int i = 0; i < 2000; ++i) {
    const double incidence = random.uniform(0, 1);
    const double azimuth = random.uniform(-4, 4);
    const double focal = random.uniform(0.05, 0.5);
    const Vector3d pivot(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                         random.uniform(-0.02, 0.02));
    const Fsm fsm({.incidence_rad = incidence,
                   .fold_azimuth_rad = azimuth,
                   .pivot_m = {pivot},
                   .focal_distance_m = focal});
    const ScannerState state = fsm.state({.aim = random.within(0.3)});
    const Vector3d pixel = random.within(0.05).v;
    const Beam beam = beam_of(fsm, state, pixel);
    const Eigen::Matrix3d fold = turn_about(Vector3d::UnitZ(), azimuth);
    const Vector3d d0 = fold * Vector3d(0, -std::sin(2 * incidence), -std::cos(2 * incidence));
    const Vector3d m0 = fold * Vector3d(0, std::sin(incidence), std::cos(incidence));
    const Vector3d e1 = fold.col(0);
    const Eigen::Matrix3d turn =
        turn_about(e1, state.angle_1_rad) * turn_about(m0.cross(e1), state.angle_2_rad);
    const auto moved = [&](const Vector3d& p) -> Vector3d { return pivot + turn * (p - pivot); };
    const Vector3d normal =
        (moved(e1) - moved(Vector3d::Zero())).cross(moved(m0.cross(e1)) - moved(e1)).normalized();
    const Vector3d incoming = beam.exit.v + focal * d0;
    EXPECT_NEAR(std::abs(normal.dot(beam.exit.v - moved(Vector3d::Zero()))), 0, 1e-15);
    EXPECT_LT(incoming.normalized().cross(reflected(pixel, m0)).norm(), 1e-14);
    ASSERT_LT((reflected(incoming.normalized(), normal) - beam.direction.v).norm(), 1e-14) << "case " << i;
    EXPECT_FALSE(beam.lost);
  }
}

TEST(FsmExit, RayThatMissesTheFrontIsLost) {
  const Fsm fsm({.incidence_rad = 80 * kDegree, .max_deflection_rad = 0.3, .focal_distance_m = 0.1});
  const ScannerState rest = fsm.state({});
  EXPECT_FALSE(beam_of(fsm, rest, towards(9 * kDegree, -kPi / 2).v).lost);
  EXPECT_TRUE(beam_of(fsm, rest, towards(11 * kDegree, -kPi / 2).v).lost);
}

// The encoder moves only what the lander believes, by sigma per tilt.
TEST(FsmEncoder, ReadsTheTiltsWithNoise) {
  const double sigma = 1e-4;
  const Fsm fsm({.incidence_rad = 0.4, .encoder_sigma_rad = sigma, .seed = 5});
  EXPECT_FALSE(fsm.is_known());
  constexpr int kPulses = 20000;
  double squares[2] = {0, 0};
  double product = 0;
  for (int k = 0; k < kPulses; ++k) {
    const PulseContext pulse{.time = {k, 0}, .aim = towards(0.2, k)};
    const ScannerState truth = fsm.state(pulse);
    const ScannerState estimated = fsm.estimated_state(pulse, truth);
    const double a = (estimated.angle_1_rad - truth.angle_1_rad) / sigma;
    const double b = (estimated.angle_2_rad - truth.angle_2_rad) / sigma;
    squares[0] += a * a;
    squares[1] += b * b;
    product += a * b;
    EXPECT_LT((line_of_sight(fsm, truth) - pulse.aim->v).norm(), 2e-15);
  }
  // Five sigma of a variance of N draws is 5 sqrt(2/N): once in two million runs.
  for (const double sum : squares) EXPECT_NEAR(sum / kPulses, 1, 5 * std::sqrt(2.0 / kPulses));
  EXPECT_NEAR(product / kPulses, 0, 5 / std::sqrt(1.0 * kPulses));
}

// Line-of-sight error = gain times tilt error: 2 in the plane of incidence, 2 cos i across.
TEST(FsmEncoder, ErrorOfTheBelievedLineOfSight) {
  const double incidence = 45 * kDegree;
  const Fsm fsm({.incidence_rad = incidence, .encoder_sigma_rad = 1e-5});
  for (int k = 0; k < 100; ++k) {
    const PulseContext pulse{.time = {k, 0}, .aim = towards(0, 0)};
    const ScannerState truth = fsm.state(pulse);
    const ScannerState estimated = fsm.estimated_state(pulse, truth);
    const Vector3d error = line_of_sight(fsm, estimated) - line_of_sight(fsm, truth);
    EXPECT_NEAR(error.y(), -2 * estimated.angle_1_rad, 1e-8);
    EXPECT_NEAR(error.x(), 2 * std::cos(incidence) * estimated.angle_2_rad, 1e-8);
  }
}

TEST(FsmEncoder, DrawsDependOnSeedAndPulseOnly) {
  const Fsm one({.encoder_sigma_rad = 1e-3, .seed = 1});
  const Fsm settling({.encoder_sigma_rad = 1e-3, .timing = {.settle_time_s = 1e-3}, .seed = 1});
  const Fsm other({.encoder_sigma_rad = 1e-3, .seed = 2});
  const PulseContext pulse{.time = {7, 0}, .aim = towards(0.1, 0)};
  const auto noise = [&](const Fsm& fsm, const PulseContext& at) {
    const ScannerState truth = fsm.state(at);
    return fsm.estimated_state(at, truth).angle_1_rad - truth.angle_1_rad;
  };
  EXPECT_EQ(noise(one, pulse), noise(settling, pulse));
  EXPECT_NE(noise(one, pulse), noise(other, pulse));
  EXPECT_NE(noise(one, pulse), noise(one, {.time = {8, 0}, .aim = pulse.aim}));
}

TEST(FsmSettling, StartsAtTheOldAimAndEndsAtTheNew) {
  const Fsm fsm({.incidence_rad = 0.3, .timing = {.settle_time_s = 1e-3}});
  EXPECT_TRUE(fsm.is_known());
  PulseContext pulse{.aim = towards(0.2, 1), .since_jump_s = 0, .aim_before_jump = towards(0.25, 3)};
  EXPECT_LT((line_of_sight(fsm, fsm.state(pulse)) - pulse.aim_before_jump->v).norm(), 2e-15);
  pulse.since_jump_s = 1;
  EXPECT_LE((line_of_sight(fsm, fsm.state(pulse)) - pulse.aim->v).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_FALSE(fsm.state(pulse).blanked);
}

// The tilts, not the line of sight, respond linearly.
TEST(FsmSettling, TiltsFollowTheResponse) {
  const MechanismTimingParameters timing{.settle_time_s = 2e-3, .settle_damping = 0.5};
  const Fsm fsm({.incidence_rad = 0.3, .timing = timing});
  const Fsm ideal({.incidence_rad = 0.3});
  const auto from = towards(0.25, 3);
  const auto to = towards(0.2, 1);
  for (const double t : {1e-4, 5e-4, 1e-3, 2e-3, 4e-3}) {
    const ScannerState a = ideal.state({.aim = from});
    const ScannerState b = ideal.state({.aim = to});
    const ScannerState state = fsm.state({.aim = to, .since_jump_s = t, .aim_before_jump = from});
    const double left = MechanismTiming(timing).step_left(t);
    EXPECT_NEAR(state.angle_1_rad, b.angle_1_rad + left * (a.angle_1_rad - b.angle_1_rad), 1e-15);
    EXPECT_NEAR(state.angle_2_rad, b.angle_2_rad + left * (a.angle_2_rad - b.angle_2_rad), 1e-15);
  }
}

TEST(FsmTurnaround, BlanksAfterAJump) {
  const Fsm fsm({.timing = {.turnaround_time_s = 1e-3}});
  EXPECT_TRUE(fsm.state({.aim = towards(0.1, 1), .since_jump_s = 0}).blanked);
  EXPECT_FALSE(fsm.state({.aim = towards(0.1, 1), .since_jump_s = 1e-3}).blanked);
  EXPECT_FALSE(fsm.state({.aim = towards(0.1, 1)}).blanked) << "no jump yet";
}

TEST(FsmLag, PixelsLookAlongTheMirrorAtTheEcho) {
  const Fsm fsm({.tof_lag = true});
  EXPECT_FALSE(fsm.is_known());
  const PulseContext pulse{.aim = towards(0.1, 1), .aim_at_echo = towards(0.101, 1)};
  const ScannerState truth = fsm.state(pulse);
  EXPECT_LT((line_of_sight(fsm, truth) - pulse.aim_at_echo->v).norm(), 2e-15);
  EXPECT_LT((line_of_sight(fsm, fsm.estimated_state(pulse, truth)) - pulse.aim->v).norm(), 2e-15);
}

TEST(FsmLag, IsOffByDefault) {
  const Fsm fsm({});
  const PulseContext pulse{.aim = towards(0.1, 1), .aim_at_echo = towards(0.101, 1)};
  EXPECT_TRUE(fsm.is_known());
  EXPECT_LT((line_of_sight(fsm, fsm.state(pulse)) - pulse.aim->v).norm(), 2e-15);
}

TEST(FsmMechanism, AsksOnlyForWhatItLooksAt) {
  EXPECT_FALSE(Fsm({}).needs().jumps || Fsm({}).needs().echo);
  EXPECT_TRUE(Fsm({.timing = {.turnaround_time_s = 1e-3}}).needs().jumps);
  EXPECT_TRUE(Fsm({.timing = {.settle_time_s = 1e-3}}).needs().jumps);
  EXPECT_TRUE(Fsm({.tof_lag = true}).needs().echo);
}

TEST(FsmMechanism, RefusesParametersOutOfRange) {
  EXPECT_THROW(Fsm({.pivot_m = {{0, std::nan(""), 0}}}), UsageError);
  EXPECT_THROW(Fsm({.focal_distance_m = -1}), UsageError);
  EXPECT_THROW(Fsm({.focal_distance_m = HUGE_VAL}), UsageError);
  EXPECT_THROW(Fsm({.encoder_sigma_rad = -1e-9}), UsageError);
  EXPECT_THROW(Fsm({.encoder_sigma_rad = std::nan("")}), UsageError);
  EXPECT_THROW(Fsm({.timing = {.turnaround_time_s = -1}}), UsageError);
}

TEST(FsmMechanism, RefusesAnEchoBeyondItsReach) {
  const Fsm fsm({.tof_lag = true});
  EXPECT_THROW(static_cast<void>(fsm.state({.aim = towards(0.1, 0), .aim_at_echo = towards(1, 0)})),
               FormatError);
}

TEST(FsmEncoder, HasHarmonicsOfEachTilt) {
  const Fsm fsm({.incidence_rad = 0.4,
                 .encoder_harmonics = {{.axis = 1, .order = 1, .amplitude_rad = 1e-4, .phase_rad = kPi / 2},
                                       {.axis = 2, .order = 50, .amplitude_rad = 2e-4},
                                       {.axis = 2, .order = 3, .amplitude_rad = -1e-4, .phase_rad = 1}}});
  EXPECT_FALSE(fsm.is_known());
  for (int k = 0; k < 50; ++k) {
    const PulseContext pulse{.time = {k, 0}, .aim = towards(0.2, k)};
    const ScannerState truth = fsm.state(pulse);
    const ScannerState read = fsm.estimated_state(pulse, truth);
    EXPECT_NEAR(read.angle_1_rad - truth.angle_1_rad, 1e-4 * std::cos(truth.angle_1_rad), 1e-15);
    EXPECT_NEAR(read.angle_2_rad - truth.angle_2_rad,
                2e-4 * std::sin(50 * truth.angle_2_rad) - 1e-4 * std::sin(3 * truth.angle_2_rad + 1), 1e-15);
    EXPECT_LT((line_of_sight(fsm, truth) - pulse.aim->v).norm(), 2e-15);
  }
}

TEST(FsmEncoder, NoiseComesOnTopOfHarmonics) {
  const std::vector<EncoderHarmonic> harmonics = {{.order = 1, .amplitude_rad = 1e-3, .phase_rad = kPi / 2}};
  const Fsm noisy({.encoder_sigma_rad = 1e-4});
  const Fsm both({.encoder_sigma_rad = 1e-4, .encoder_harmonics = harmonics});
  const PulseContext pulse{.time = {7, 0}, .aim = towards(0, 0)};
  const ScannerState truth = both.state(pulse);
  EXPECT_NEAR(both.estimated_state(pulse, truth).angle_1_rad,
              noisy.estimated_state(pulse, truth).angle_1_rad + 1e-3, 1e-15);
}

TEST(FsmEncoder, RefusesHarmonicsOutOfRange) {
  const auto refused = [](const EncoderHarmonic& harmonic, const std::string& key) {
    EXPECT_THAT(refusal([&] {
                  const Fsm fsm({.encoder_harmonics = {{}, harmonic}});
                }),
                testing::HasSubstr("encoder_harmonics/1/" + key));
  };
  refused({.axis = 0}, "axis");
  refused({.axis = 3}, "axis");
  refused({.order = 0}, "order");
  refused({.order = (1 << 20) + 1}, "order");
  refused({.amplitude_rad = HUGE_VAL}, "amplitude_rad");
  refused({.phase_rad = std::nan("")}, "phase_deg");
}

// Rest to rest, 0.2 rad of tilt 1 at an incidence of 0: 2 sqrt(0.2/100) after the last pulse before the jump.
TEST(FsmTurnaround, LastsUntilTheMirrorHasCaughtUp) {
  const Fsm fsm({.max_deflection_rad = 0.5, .timing = {.max_acceleration_radps2 = 100}});
  EXPECT_TRUE(fsm.needs().motion && fsm.needs().jumps);
  EXPECT_FALSE(Fsm({}).needs().motion);
  const auto down = towards(0.2, -kPi / 2);
  const auto up = towards(0.2, kPi / 2);
  PulseContext pulse{.aim = up, .since_jump_s = 0.088, .jump_aims = JumpAims{down, down, up, up, 1e-3}};
  EXPECT_TRUE(fsm.state(pulse).blanked);
  pulse.since_jump_s = 0.089;
  EXPECT_FALSE(fsm.state(pulse).blanked);
  EXPECT_THROW(Fsm({.timing = {.max_acceleration_radps2 = -1}}), UsageError);
}

}  // namespace
}  // namespace landfall
