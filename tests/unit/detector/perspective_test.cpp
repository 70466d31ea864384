// SPDX-License-Identifier: GPL-3.0-or-later
#include "detector/perspective.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "geometry/rotation.h"

namespace landfall {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Where a direction in L meets the plane z_D = -1, seen from the origin with the nominal mount: map
// coordinates.
Eigen::Vector2d on_map(const Direction<LidarFrame>& d) {
  const auto mount = rotation_from<BodyFrame, LidarFrame>({kPi, 0, 0});
  const Eigen::Vector3d in_body = mount.m * d.v;
  return in_body.head<2>() / -in_body.z();
}

PerspectiveParameters two_by_three(double pitch_x, double pitch_y) {
  return {.rows = 2, .columns = 3, .field_of_view = PixelFieldOfView{pitch_x, pitch_y}};
}

TEST(Perspective, DefaultIsThePapersDetector) {
  const Detector detector = perspective_detector({});
  EXPECT_EQ(detector.pixel_count(), 324U);
  EXPECT_EQ(detector.samples_per_pixel(), 1U);
  const Eigen::Vector2d last = on_map(detector.pixels()[323]);
  EXPECT_NEAR(last.x(), 8.5 * 1.6e-3 / 18, 1e-18);
  EXPECT_NEAR(last.y(), -8.5 * 1.6e-3 / 18, 1e-18);
}

TEST(Perspective, TopRowLooksNorthFirstColumnWest) {
  const Detector detector = perspective_detector(two_by_three(0.1, 0.2));
  ASSERT_EQ(detector.pixel_count(), 6U);
  const double expected[6][2] = {{-0.1, 0.1}, {0, 0.1}, {0.1, 0.1}, {-0.1, -0.1}, {0, -0.1}, {0.1, -0.1}};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LT((on_map(detector.pixels()[i]) - Eigen::Vector2d(expected[i][0], expected[i][1])).norm(), 1e-16);
    EXPECT_NEAR(detector.pixels()[i].v.norm(), 1, 2e-16);
  }
}

TEST(Perspective, MiddlePixelLooksAlongTheBoresight) {
  const Detector detector = perspective_detector({.rows = 3, .columns = 3, .roll_rad = 0.3});
  EXPECT_EQ(detector.pixels()[4].v, Eigen::Vector3d::UnitZ());
}

// A quarter turn counter-clockwise takes what looked west to the south, and what looked north to the west.
TEST(Perspective, RollTurnsCounterClockwiseOnTheMap) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.roll_rad = kPi / 2;
  const Detector detector = perspective_detector(parameters);
  EXPECT_LT((on_map(detector.pixels()[0]) - Eigen::Vector2d(-0.1, -0.1)).norm(), 1e-16);
  EXPECT_LT((on_map(detector.pixels()[1]) - Eigen::Vector2d(-0.1, 0)).norm(), 1e-16);
  EXPECT_LT((on_map(detector.pixels()[5]) - Eigen::Vector2d(0.1, 0.1)).norm(), 1e-16);
}

TEST(Perspective, RollIsRightHandedAboutMinusZ) {
  auto parameters = two_by_three(0.1, 0.2);
  const Detector straight = perspective_detector(parameters);
  parameters.roll_rad = 0.135;
  const Detector rolled = perspective_detector(parameters);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.135, -Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_LT((rolled.pixels()[i].v - turn * straight.pixels()[i].v).norm(), 3e-16);
}

// A field of view of 90 x 60 deg reaches tan 45 deg and tan 30 deg at the outer edges of the outer pixels.
TEST(Perspective, FieldOfViewIsEdgeToEdge) {
  const Detector detector =
      perspective_detector({.rows = 2, .columns = 4, .field_of_view = FullFieldOfView{kPi / 2, kPi / 3}});
  const Eigen::Vector2d upper_left = on_map(detector.pixels()[0]);
  EXPECT_NEAR(upper_left.x(), -0.75, 1e-15);
  EXPECT_NEAR(upper_left.y(), 0.5 * std::tan(kPi / 6), 1e-15);
}

TEST(Perspective, SubpixelsTileTheirPixel) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.subpixels = 2;
  const Detector detector = perspective_detector(parameters);
  ASSERT_EQ(detector.samples().size(), 24U);
  // Pixel (0, 1) has its centre at (0, 0.1); its quarters lie 0.025 and 0.05 away, the upper ones first.
  const double expected[4][2] = {{-0.025, 0.15}, {0.025, 0.15}, {-0.025, 0.05}, {0.025, 0.05}};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((on_map(detector.samples()[4 + i]) - Eigen::Vector2d(expected[i][0], expected[i][1])).norm(),
              1e-16);
}

TEST(Perspective, MiddleOfOddSubpixelsIsThePixel) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.subpixels = 3;
  const Detector detector = perspective_detector(parameters);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(detector.samples()[9 * i + 4], detector.pixels()[i]);
}

TEST(Perspective, RefusesWhatIsOutOfRange) {
  const auto refused = [](PerspectiveParameters p) {
    EXPECT_THROW(static_cast<void>(perspective_detector(p)), UsageError);
  };
  refused({.rows = 0});
  refused({.rows = 4097});
  refused({.columns = 0});
  refused({.columns = 4097});
  refused({.subpixels = 0});
  refused({.subpixels = 65});
  refused({.rows = 4096, .columns = 4096, .subpixels = 3});
  refused({.roll_rad = kNan});
  for (const double bad : {0.0, -1e-4, kNan, std::numeric_limits<double>::infinity()}) {
    refused({.field_of_view = PixelFieldOfView{bad, 1e-4}});
    refused({.field_of_view = PixelFieldOfView{1e-4, bad}});
    refused({.field_of_view = FullFieldOfView{bad, 1}});
  }
  refused({.field_of_view = FullFieldOfView{1, kPi}});
}

TEST(Perspective, MessageNamesKeyValueAndBound) {
  try {
    static_cast<void>(perspective_detector({.rows = 5000}));
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("rows: 5000 is not in 1..4096"));
  }
}

}  // namespace
}  // namespace landfall
