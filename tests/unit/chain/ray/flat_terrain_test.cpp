// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/ray/flat_terrain.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace landfall {
namespace {

double range_to(double elevation_m, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const std::array<Ray, 1> rays = {Ray{{origin}, {direction}}};
  std::array<double, 1> ranges{};
  FlatTerrain(elevation_m).first_hits(rays, ranges);
  return ranges[0];
}

TEST(FlatTerrain, RangesAreClosedForm) {
  EXPECT_EQ(range_to(0, {1, 2, 500}, {0, 0, -1}), 500);
  EXPECT_EQ(range_to(7, {1, 2, 500}, {0.6, 0, -0.8}), 493 / 0.8);
  EXPECT_EQ(range_to(0, {0, 0, -4}, {0, 0.6, 0.8}), 5);  // from below
  EXPECT_EQ(range_to(3, {0, 0, 3}, {0, 0, -1}), 0);
}

TEST(FlatTerrain, AwayFromItAndAlongItMiss) {
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, 500}, {0, 0, 1})));
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, 500}, {1, 0, 0})));
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, -5}, {1, 0, 0})));
  EXPECT_TRUE(std::isnan(range_to(0, {0, 0, 0}, {1, 0, 0})));
}

}  // namespace
}  // namespace landfall
