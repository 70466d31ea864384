// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/perspective.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/core/error.h"
#include "base/geometry/rotation.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

// The point at which a direction in L meets the plane z_D = -1, seen from the origin with the nominal mount:
// map coordinates.
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

// Line arrays and long detectors: the pitch of one axis does not depend on the other.
TEST(Perspective, AnyAspect) {
  const auto place = [](int rows, int columns, std::size_t pixel) {
    return on_map(perspective_detector(
                      {.rows = rows, .columns = columns, .field_of_view = PixelFieldOfView{0.01, 0.02}})
                      .pixels()[pixel]);
  };
  EXPECT_LT((place(1, 128, 0) - Eigen::Vector2d(-0.635, 0)).norm(), 1e-16);
  EXPECT_LT((place(1, 128, 127) - Eigen::Vector2d(0.635, 0)).norm(), 1e-16);
  EXPECT_LT((place(128, 1, 0) - Eigen::Vector2d(0, 1.27)).norm(), 3e-16);
  EXPECT_LT((place(64, 4, 0) - Eigen::Vector2d(-0.015, 0.63)).norm(), 2e-16);
  EXPECT_LT((place(64, 4, 255) - Eigen::Vector2d(0.015, -0.63)).norm(), 2e-16);
  EXPECT_LT((place(64, 4, 6) - Eigen::Vector2d(0.005, 0.61)).norm(), 2e-16);
}

// Pixel (0, 0) lies at (-0.1, 0.1): r^2 = 0.02.
TEST(Perspective, DistortionMovesPlacesAlongTheirRadius) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.distortion = {5, 100, 1000};
  const double factor = 1 + 5 * 0.02 + 100 * 0.0004 + 1000 * 0.000008;
  const Detector detector = perspective_detector(parameters);
  EXPECT_LT((on_map(detector.pixels()[0]) - factor * Eigen::Vector2d(-0.1, 0.1)).norm(), 1e-16);
  EXPECT_LT((on_map(detector.pixels()[1]) - 1.061 * Eigen::Vector2d(0, 0.1)).norm(), 1e-16);
  parameters.roll_rad = kPi / 2;
  EXPECT_LT(
      (on_map(perspective_detector(parameters).pixels()[0]) - factor * Eigen::Vector2d(-0.1, -0.1)).norm(),
      1e-16);
}

TEST(Perspective, DistortionMovesSubpixelsByTheirOwnRadius) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.subpixels = 2;
  parameters.distortion = {5, 0, 0};
  const Eigen::Vector2d straight(-0.125, 0.15);
  EXPECT_LT(
      (on_map(perspective_detector(parameters).samples()[0]) - (1 + 5 * straight.squaredNorm()) * straight)
          .norm(),
      1e-16);
}

TEST(Perspective, WithoutDistortionFillOrTableNotABitChanges) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.subpixels = 3;
  parameters.roll_rad = 0.3;
  const Detector plain = perspective_detector(parameters);
  for (int row = 0; row < 2; ++row)
    for (int col = 0; col < 3; ++col) parameters.points.push_back({(col - 1) * 0.1, (0.5 - row) * 0.2});
  const Detector table = perspective_detector(parameters);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(table.pixels()[i], plain.pixels()[i]);
  for (std::size_t i = 0; i < 54; ++i) EXPECT_LT((table.samples()[i].v - plain.samples()[i].v).norm(), 1e-15);
}

TEST(Perspective, FillFactorShrinksThePixelsNotTheirPitch) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.subpixels = 2;
  parameters.fill_factor = 0.25;
  const Detector detector = perspective_detector(parameters);
  const double expected[4][2] = {{-0.0125, 0.125}, {0.0125, 0.125}, {-0.0125, 0.075}, {0.0125, 0.075}};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((on_map(detector.samples()[4 + i]) - Eigen::Vector2d(expected[i][0], expected[i][1])).norm(),
              1e-16);
  EXPECT_LT((on_map(detector.pixels()[0]) - Eigen::Vector2d(-0.1, 0.1)).norm(), 1e-16);
}

TEST(Perspective, FillFactorDoesNothingToPixelsOfOneRay) {
  auto parameters = two_by_three(0.1, 0.2);
  const Detector whole = perspective_detector(parameters);
  parameters.fill_factor = 0.1;
  const Detector part = perspective_detector(parameters);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(part.samples()[i], whole.samples()[i]);
}

TEST(Perspective, TableOfPlaces) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.points = {{0, 0}, {0.3, 0.1}, {-0.2, 0.4}, {0.1, -0.1}, {0, 0}, {1, 1}};
  parameters.subpixels = 2;
  const Detector detector = perspective_detector(parameters);
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Vector2d place(parameters.points[i].u, parameters.points[i].v);
    EXPECT_LT((on_map(detector.pixels()[i]) - place).norm(), 3e-16);
    EXPECT_LT((on_map(detector.samples()[4 * i]) - (place + Eigen::Vector2d(-0.025, 0.05))).norm(), 3e-16);
  }
}

TEST(Perspective, PassesItsEstimatorOn) {
  std::vector<double> ranges = {3, 1, 8};
  EXPECT_EQ(perspective_detector({.estimator = {.rule = RangeRule::first}}).estimator().range_m(ranges), 1);
}

// r - r^3/3 folds at 1. The outer corner of 2 x 3 pixels of (0.1, 0.2) lies at hypot(0.15, 0.2) = 0.25.
TEST(Perspective, RefusesAnImageThatFolds) {
  auto parameters = two_by_three(0.1, 0.2);
  parameters.distortion.k1 = -1 / (3 * 0.2501 * 0.2501);
  EXPECT_NO_THROW(static_cast<void>(perspective_detector(parameters)));
  parameters.distortion.k1 = -1 / (3 * 0.2499 * 0.2499);
  EXPECT_THAT(refusal([&] { return perspective_detector(parameters); }),
              testing::AllOf(testing::HasSubstr("distortion: the image folds at radius 0.249"),
                             testing::HasSubstr("outer radius 0.25 ")));
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
  for (const double bad : {0.0, -0.5, 1.001, kNan}) refused({.fill_factor = bad});
  refused({.distortion = {kNan, 0, 0}});
  refused({.distortion = {0, kNan, 0}});
  refused({.distortion = {0, 0, kNan}});
  refused({.points = {{0, 0}, {0, 0}}});
  refused({.estimator = {.range_resolution_m = 0}});
  for (const double bad : {0.0, -1e-4, kNan, std::numeric_limits<double>::infinity()}) {
    refused({.field_of_view = PixelFieldOfView{bad, 1e-4}});
    refused({.field_of_view = PixelFieldOfView{1e-4, bad}});
    refused({.field_of_view = FullFieldOfView{bad, 1}});
  }
  refused({.field_of_view = FullFieldOfView{1, kPi}});
}

TEST(Perspective, MessageNamesKeyValueAndBound) {
  EXPECT_THAT(refusal([&] { return perspective_detector({.rows = 5000}); }),
              testing::HasSubstr("rows: 5000 is not in 1..4096"));
}

}  // namespace
}  // namespace landfall
