// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/risley_steering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "constants.h"
#include "risley_cases.h"
#include "steering.h"

namespace landfall {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;
using enum RisleyConfiguration;
using enum RisleyBranch;

double off_axis(const Vector3d& d) { return std::atan2(std::hypot(d.x(), d.y()), d.z()); }

/// |where the angles for `aim` send the boresight - aim|.
double miss(const RisleySteering& steering, const Direction<LidarFrame>& aim, RisleyBranch branch) {
  const auto angles = steering.angles(aim, branch);
  if (!angles) return HUGE_VAL;
  const double turn = std::sin(angles->theta_2_rad - angles->theta_1_rad);
  EXPECT_GE(branch == positive ? turn : -turn, -1e-15);
  const auto back = steering.direction(*angles);
  return back ? (back->v - aim.v).norm() : HUGE_VAL;
}

TEST(RisleySteering, ReachOfTheFourConfigurations) {
  const double max_deg[] = {8.579681, 8.661874, 8.703017, 8.539335};
  const double min_deg[] = {0, 0, 0.0403, 0.0396};
  for (const RisleyConfiguration configuration : kRisleyConfigurations) {
    const auto reach = RisleySteering({.configuration = configuration}).reach();
    const auto i = static_cast<std::size_t>(configuration);
    ASSERT_TRUE(reach.has_value());
    EXPECT_NEAR(reach->max_rad / kDegree, max_deg[i], 5e-7) << letters(configuration);
    EXPECT_NEAR(reach->min_rad / kDegree, min_deg[i], 5e-5) << letters(configuration);
  }
}

// Equal prisms face to face in one turn are a plate: PTTP and TPPT let the boresight straight through.
TEST(RisleySteering, MirroredPrismsCancel) {
  for (const RisleyConfiguration configuration : {pttp, tppt})
    for (double turn = -3; turn < 3; turn += 0.37)
      EXPECT_LT(
          (RisleySteering({.configuration = configuration}).direction({turn, turn})->v - Vector3d::UnitZ())
              .norm(),
          1e-15);
}

// One wedge alone, the other a plate: asin(n sin a) - a with the plane face first, else
// asin(sin a (sqrt(n^2 - sin^2 a) - cos a)).
TEST(RisleySteering, SingleWedge) {
  for (const double n : {1.3, 1.5, 2.0})
    for (const double a : {0.01, 0.1, 0.3}) {
      const double plane_first = std::asin(n * std::sin(a)) - a;
      const double tilted_first =
          std::asin(std::sin(a) * (std::sqrt(n * n - std::sin(a) * std::sin(a)) - std::cos(a)));
      for (const RisleyConfiguration configuration : kRisleyConfigurations)
        for (const std::size_t wedge : {0U, 1U}) {
          RisleyOptics optics{.configuration = configuration};
          optics.prisms[wedge] = {.index = n, .wedge_rad = a};
          optics.prisms[1 - wedge] = {.index = 1.4, .wedge_rad = 0};
          const Vector3d d = RisleySteering(optics).direction({1, 1})->v;
          const bool at_exit = letters(configuration)[2 * wedge + 1] == 'T';
          EXPECT_NEAR(off_axis(d), at_exit ? plane_first : tilted_first, 1e-15);
          // Towards the thick side: away from the lean of a face at the exit, along that of one at the entry.
          EXPECT_NEAR(std::atan2(d.y(), d.x()), at_exit ? 1 - kPi : 1, 1e-13);
        }
    }
}

// Only the difference of the angles changes the deflection; turning both turns the beam.
TEST(RisleySteering, TurnsWithBothPrisms) {
  RisleyDraws draws;
  for (const RisleyConfiguration configuration : kRisleyConfigurations)
    for (int i = 0; i < 100; ++i) {
      const RisleySteering steering(draws.optics(configuration));
      const RisleyAngles angles = draws.angles();
      const double turn = draws.uniform(-3, 3);
      const Vector3d expected = Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * steering.direction(angles)->v;
      const Vector3d turned = steering.direction({angles.theta_1_rad + turn, angles.theta_2_rad + turn})->v;
      ASSERT_LT((turned - expected).norm(), 2e-15);
    }
}

TEST(RisleySteering, InverseRoundTrip) {
  RisleyDraws draws;
  double worst = 0;
  for (const RisleyConfiguration configuration : kRisleyConfigurations)
    for (int i = 0; i < 10000; ++i) {
      const RisleySteering steering(draws.optics(configuration));
      const auto reach = steering.reach();
      if (!reach) continue;
      const auto aim = towards(draws.uniform(reach->min_rad, reach->max_rad), draws.uniform(-kPi, kPi));
      worst = std::max({worst, miss(steering, aim, positive), miss(steering, aim, negative)});
    }
  EXPECT_LT(worst, 5e-15);
}

// At both ends of the reach the two branches meet, and an arc cosine would lose half of the digits.
TEST(RisleySteering, InverseRoundTripAtTheEndsOfTheReach) {
  for (const RisleyConfiguration configuration : kRisleyConfigurations) {
    const RisleySteering steering({.configuration = configuration});
    for (const double inside : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3})
      for (double azimuth = -3; azimuth < 3; azimuth += 0.7)
        for (const double off : {steering.reach()->min_rad + inside, steering.reach()->max_rad - inside}) {
          EXPECT_LT(miss(steering, towards(off, azimuth), positive), 1e-14) << letters(configuration) << off;
          EXPECT_LT(miss(steering, towards(off, azimuth), negative), 1e-14) << letters(configuration) << off;
        }
  }
}

TEST(RisleySteering, StraightAheadIsWithinReachOfMirroredPrisms) {
  for (const RisleyConfiguration configuration : {pttp, tppt})
    EXPECT_LT(miss(RisleySteering({.configuration = configuration}), {Vector3d::UnitZ()}, positive), 1e-15);
}

// Forward, inverse: the angles come back, up to whole turns.
TEST(RisleySteering, AnglesComeBack) {
  RisleyDraws draws;
  for (const RisleyConfiguration configuration : kRisleyConfigurations)
    for (int i = 0; i < 1000; ++i) {
      const RisleySteering steering(draws.optics(configuration));
      const double theta_1 = draws.uniform(-3, 3);
      const double turn = draws.uniform(0.1, kPi - 0.1);
      for (const RisleyBranch branch : {positive, negative}) {
        const double theta_2 = theta_1 + (branch == positive ? turn : -turn);
        const auto angles = steering.angles(*steering.direction({theta_1, theta_2}), branch);
        ASSERT_TRUE(angles.has_value());
        EXPECT_NEAR(std::remainder(angles->theta_1_rad - theta_1, 2 * kPi), 0, 1e-11);
        EXPECT_NEAR(std::remainder(angles->theta_2_rad - theta_2, 2 * kPi), 0, 1e-11);
      }
    }
}

TEST(RisleySteering, AimsOutsideTheReachHaveNoAngles) {
  for (const RisleyConfiguration configuration : kRisleyConfigurations) {
    const RisleySteering steering({.configuration = configuration});
    EXPECT_FALSE(steering.angles(towards(steering.reach()->max_rad + 1e-12, 1), positive).has_value());
    EXPECT_FALSE(steering.angles({-Vector3d::UnitZ()}, positive).has_value());
    EXPECT_FALSE(steering.angles({{std::nan(""), 0, 1}}, positive).has_value());
    if (steering.reach()->min_rad > 1e-9) {
      EXPECT_FALSE(steering.angles(towards(steering.reach()->min_rad - 1e-12, 1), positive).has_value());
      EXPECT_FALSE(steering.angles({Vector3d::UnitZ()}, positive).has_value());
    }
  }
}

// n = 1.5: a face tilted by 42 deg at prism 1's exit is beyond the critical angle, 41.81 deg.
TEST(RisleySteering, TotalReflectionInPrismOne) {
  const RisleyPrism steep{.wedge_rad = 42 * kDegree};
  const RisleySteering steering({.prisms = {steep, {}}});
  EXPECT_FALSE(steering.direction({0.3, 1}).has_value());
  EXPECT_FALSE(steering.reach().has_value());
  EXPECT_FALSE(steering.angles(towards(0.05, 0), positive).has_value());
  const RisleySteering reversed({.prisms = {steep, {}}, .configuration = tptp});
  EXPECT_TRUE(reversed.direction({0.3, 1}).has_value());
}

// TPPT, 32 deg wedges, n = 1.5: opposed, the ray meets prism 2's tilted face at 43.3 deg, beyond the critical
// angle. Up to the grazing exit every aim works.
TEST(RisleySteering, TotalReflectionBoundsTheReach) {
  const RisleyPrism prism{.wedge_rad = 32 * kDegree};
  const RisleySteering steering({.prisms = {prism, prism}, .configuration = tppt});
  EXPECT_TRUE(steering.direction({0, 0}).has_value());
  EXPECT_FALSE(steering.direction({0, kPi}).has_value());
  const auto reach = steering.reach();
  ASSERT_TRUE(reach.has_value());
  EXPECT_NEAR(reach->min_rad, 0, 1e-15);
  // The bend grows without bound towards the grazing exit, and with it what rounding does to the beam.
  for (double inside = reach->max_rad; inside > 1e-6; inside *= 0.9)
    EXPECT_LT(miss(steering, towards(reach->max_rad - inside, 2), positive), 2e-15 / inside) << inside;
  EXPECT_FALSE(steering.angles(towards(reach->max_rad + 1e-9, 2), positive).has_value());
}

TEST(RisleySteering, RefusesOpticsOutOfRange) {
  const auto refused = [](const RisleyOptics& optics, const char* text) {
    EXPECT_THAT([&] { check(optics); }, ThrowsMessage<UsageError>(HasSubstr(text)));
  };
  refused({.prisms = {{{.index = 1}, {}}}}, "index/0: 1 is not in (1, 10]");
  refused({.prisms = {{{}, {.index = std::nan("")}}}}, "index/1");
  refused({.prisms = {{{.wedge_rad = -kPi / 18}, {}}}}, "wedge_deg/0: -10 is not in [0, 90)");
  refused({.prisms = {{{}, {.wedge_rad = kPi / 2}}}}, "wedge_deg/1");
  refused({.prisms = {{{.thickness_m = 0}, {}}}}, "thickness_m/0: 0 is not in (0, 10]");
  refused({.gap_m = -1e-9}, "gap_m: -1e-09 is not in [0, 10]");
  EXPECT_NO_THROW(check(RisleyOptics{.gap_m = 0}));
}

}  // namespace
}  // namespace landfall
