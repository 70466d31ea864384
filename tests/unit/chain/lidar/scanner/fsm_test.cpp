// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/fsm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/core/error.h"
#include "base/numerics/random.h"
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

}  // namespace
}  // namespace landfall
