// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/geometry/vector_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "refusal.h"

namespace landfall {
namespace {

TEST(GeometryCheck, DegreesAreRoundedForPeople) {
  EXPECT_EQ(in_degrees(std::numbers::pi / 6), 30);
  EXPECT_EQ(in_degrees(-std::numbers::pi), -180);
  EXPECT_EQ(in_degrees(1e-9 * std::numbers::pi / 180), 1e-9);
  EXPECT_EQ(in_degrees(1e-10 * std::numbers::pi / 180), 0);
}

TEST(GeometryCheck, AnAngleIsNamedInDegrees) {
  const auto check = [](bool holds) {
    require_angle(holds, {"scanner", "tilt_deg"}, std::numbers::pi / 2, "below 45");
  };
  EXPECT_EQ(refusal([&] { check(true); }), "accepted");
  EXPECT_THAT(refusal([&] { check(false); }), testing::HasSubstr("scanner/tilt_deg: 90 is not below 45"));
}

TEST(GeometryCheck, TheComponentThatIsNotFiniteIsNamed) {
  const auto of_vector = [](const Eigen::Vector3d& v) { require_finite({"lander", "v"}, v); };
  EXPECT_EQ(refusal([&] { of_vector({1, 2, 3}); }), "accepted");
  EXPECT_THAT(refusal([&] { of_vector({NAN, 2, 3}); }), testing::HasSubstr("lander/v/0"));
  EXPECT_THAT(refusal([&] { of_vector({1, 2, HUGE_VAL}); }), testing::HasSubstr("lander/v/2"));
  const struct {
    Eigen::Vector3d v{1, 2, 3};
    double after = NAN;
  } larger;
  EXPECT_EQ(refusal([&] { of_vector(larger.v); }), "accepted");
  const auto of_angles = [](const RollPitchYaw& rpy) { require_finite({"lander", "rpy"}, rpy); };
  EXPECT_EQ(refusal([&] { of_angles({1, 2, 3}); }), "accepted");
  EXPECT_THAT(refusal([&] { of_angles({1, NAN, 3}); }), testing::HasSubstr("lander/rpy/1"));
}

}  // namespace
}  // namespace landfall
