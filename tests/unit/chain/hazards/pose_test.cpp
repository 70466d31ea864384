// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/numerics/random.h"
#include "bins.h"
#include "brute_force.h"
#include "chain/hazards/measures.h"

namespace landfall {
namespace {

using testing_hazards::random_map;

Grid<double> map_of(const std::function<double(double, double)>& z) {
  const GridSpec spec = GridSpec::centered(2, 0.05);
  return grid_of(spec, z);
}

double plane_z_m(const GridSpec& spec, BinIndex place, const LanderPose& pose, BinIndex bin) {
  return pose.centre_z_m + pose.east * (spec.x(bin.col) - spec.x(place.col)) +
         pose.north * (spec.y(bin.row) - spec.y(place.row));
}

double distance_m(const Grid<double>& z, BinIndex place, const LanderPose& pose, BinIndex bin) {
  return (z.at(bin) - plane_z_m(z.spec(), place, pose, bin)) *
         std::cos(pose.slope_deg * std::numbers::pi / 180);
}

// The bin is where the pose says, no bin under the body is farther off, and the pads touch or hang.
void check_pose(const Grid<double>& z, const LanderStencil& lander, BinIndex place, const LanderPose& pose) {
  ASSERT_NEAR(distance_m(z, place, pose, pose.highest), pose.roughness_m, 1e-9);
  for (std::int64_t r = -lander.body.half_bins(); r <= lander.body.half_bins(); ++r)
    for (std::int64_t c = -lander.body.half_width(r); c <= lander.body.half_width(r); ++c)
      ASSERT_LE(distance_m(z, place, pose, {place.row + r, place.col + c}), pose.roughness_m + 1e-9);
  ASSERT_EQ(pose.pads.size(), static_cast<std::size_t>(lander.legs));
  int touching = 0;
  for (const LanderPose::Pad& pad : pose.pads) {
    const double above = plane_z_m(z.spec(), place, pose, pad.bin) - pad.z_m;
    touching += pad.touches ? 1 : 0;
    if (pad.touches)
      ASSERT_NEAR(above, 0, 1e-9);
    else
      ASSERT_GE(above, -1e-9);
  }
  ASSERT_EQ(touching, 3);
  const double step_rad = 2 * std::numbers::pi / lander.legs / static_cast<double>(lander.yaws.size());
  const BinOffset& first = lander.yaws.at(static_cast<std::size_t>(std::lround(pose.yaw_rad / step_rad)))[0];
  ASSERT_EQ(pose.pads[0].bin, (BinIndex{place.row + first.rows, place.col + first.cols}));
}

TEST(Pose, HasTheSlopeAndRoughnessOfTheLayers) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const RandomField field(seed, RandomStream::range_noise);
    const Lander lander{.legs = seed % 2 == 0 ? 3 : 4,
                        .leg_radius_m = 0.2 + 0.3 * field.uniform(1),
                        .pad_diameter_m = 0.05 + 0.3 * field.uniform(2),
                        .pad_height = seed % 3 == 0 ? PadHeight::mean : PadHeight::max,
                        .body_radius_m = 0.1 + 0.4 * field.uniform(3)};
    const Grid<double> z = random_map({0.1, -12, -9, 21, 24}, seed, seed % 4 == 0 ? 0 : 0.003);
    const LanderStencil stencil(lander, 0.1);
    const BinMask all(z.spec(), 1);
    const PlaceMeasures contact = measure_contact(z, stencil, all);
    const PlaceMeasures plane = measure_plane(z, stencil, all);
    for (const BinIndex place : bins_of(z.spec())) {
      const auto standing = worst_contact_poses(z, stencil, place);
      ASSERT_EQ(standing.has_value(), !std::isnan(contact.slope_deg.at(place)));
      if (standing) {
        ASSERT_NEAR(standing->steepest.slope_deg, contact.slope_deg.at(place), 1e-9);
        ASSERT_NEAR(standing->roughest.roughness_m, contact.roughness_m.at(place), 1e-9);
        ASSERT_LE(standing->roughest.slope_deg, standing->steepest.slope_deg);
        check_pose(z, stencil, place, standing->steepest);
        check_pose(z, stencil, place, standing->roughest);
      }
      const auto fitted = least_squares_poses(z, stencil, place);
      ASSERT_EQ(fitted.has_value(), !std::isnan(plane.slope_deg.at(place)));
      if (!fitted) continue;
      ASSERT_NEAR(fitted->steepest.slope_deg, plane.slope_deg.at(place), 1e-9);
      ASSERT_NEAR(fitted->roughest.roughness_m, plane.roughness_m.at(place), 1e-9);
      ASSERT_NEAR(std::abs(distance_m(z, place, fitted->roughest, fitted->roughest.highest)),
                  fitted->roughest.roughness_m, 1e-9);
      ASSERT_TRUE(fitted->steepest.pads.empty());
    }
  }
}

// A post of 0.2 m under the pad of leg 0 to the east. The diagonal with the post is the higher one; the
// lander rocks onto leg 1 or leg 3, each 0.1 m below the diagonal's middle.
TEST(Pose, APostUnderAPad) {
  const Grid<double> z =
      map_of([](double x, double y) { return std::abs(x - 0.85) < 0.01 && std::abs(y) < 0.01 ? 0.2 : 0.0; });
  const LanderStencil lander({}, 0.05);
  const BinIndex origin = z.spec().bin_of(0, 0);
  const auto poses = worst_contact_poses(z, lander, origin);
  ASSERT_TRUE(poses);
  const LanderPose& pose = poses->steepest;
  EXPECT_EQ(pose.yaw_rad, 0);
  EXPECT_EQ(pose.pads[0].bin, (z.spec().bin_of(0.85, 0)));
  EXPECT_EQ(pose.pads[1].bin, (z.spec().bin_of(0, 0.85)));
  EXPECT_EQ(pose.pads[0].z_m, 0.2);
  EXPECT_EQ(pose.pads[2].z_m, 0);
  EXPECT_NEAR(pose.centre_z_m, 0.1, 1e-12);
  EXPECT_NEAR(pose.east, 0.1 / 0.85, 1e-12);
  EXPECT_NEAR(pose.north, -0.1 / 0.85, 1e-12);
  EXPECT_TRUE(pose.pads[0].touches && pose.pads[1].touches && pose.pads[2].touches);
  EXPECT_FALSE(pose.pads[3].touches);
  EXPECT_EQ(poses->roughest.highest, (z.spec().bin_of(0.85, 0)));  // the post itself, between two pads
}

TEST(Pose, APostUnderTheBody) {
  const Grid<double> z =
      map_of([](double x, double y) { return std::hypot(x - 0.3, y + 0.2) < 0.01 ? 0.25 : 0.0; });
  for (const int legs : {3, 4}) {
    const auto poses = worst_contact_poses(z, LanderStencil({.legs = legs}, 0.05), z.spec().bin_of(0, 0));
    ASSERT_TRUE(poses);
    EXPECT_EQ(poses->roughest.highest, (z.spec().bin_of(0.3, -0.2)));
    EXPECT_NEAR(poses->roughest.roughness_m, 0.25, 1e-12);
    EXPECT_EQ(poses->steepest.slope_deg, 0);
  }
}

// A pit is as far off a fitted plane as a post; nothing else is under a body of 2 bins.
TEST(Pose, AFittedPlaneIsMeasuredOnBothSides) {
  Grid<double> z(GridSpec{0.1, -5, -5, 11, 11}, 1e4);
  z.at({4, 6}) -= 0.5;
  const auto poses =
      least_squares_poses(z, LanderStencil({.leg_radius_m = 0.2, .body_radius_m = 0.2}, 0.1), {5, 5});
  ASSERT_TRUE(poses);
  EXPECT_EQ(poses->steepest.highest, (BinIndex{4, 6}));
  EXPECT_NEAR(poses->steepest.centre_z_m, 1e4 - 0.5 / 13, 1e-9);
  EXPECT_EQ(poses->steepest.yaw_rad, 0);
  EXPECT_GT(poses->steepest.north, 0);
  EXPECT_LT(poses->steepest.east, 0);
}

TEST(Pose, NoneWhereTheMapEnds) {
  const Grid<double> z(GridSpec{0.1, 0, 0, 11, 11}, 1);
  const LanderStencil lander({.leg_radius_m = 0.4, .pad_diameter_m = 0.25, .body_radius_m = 0.2}, 0.1);
  EXPECT_TRUE(worst_contact_poses(z, lander, {5, 5}));
  EXPECT_FALSE(worst_contact_poses(z, lander, {4, 5}));
  EXPECT_TRUE(least_squares_poses(z, lander, {2, 2}));
  EXPECT_FALSE(least_squares_poses(z, lander, {1, 2}));
}

}  // namespace
}  // namespace landfall
