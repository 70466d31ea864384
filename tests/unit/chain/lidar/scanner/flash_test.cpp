// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/scanner.h"

#include <gtest/gtest.h>

#include <array>

namespace landfall {
namespace {

TEST(Flash, LeavesThePixelsAlone) {
  const Flash flash;
  const std::array<Direction<LidarFrame>, 2> pixels{{{{0.6, 0, 0.8}}, {{0, -0.6, 0.8}}}};
  std::array<Beam, 2> beams{Beam{.exit = {{1, 1, 1}}, .lost = true}, Beam{}};
  const ScannerState state = flash.state({.time = {3, 0.5}, .aim = Direction<LidarFrame>{{0, 0.6, 0.8}}});
  flash.steer(state, pixels, beams);
  EXPECT_EQ(state.angle_1_rad, 0);
  EXPECT_EQ(state.angle_2_rad, 0);
  EXPECT_FALSE(state.blanked);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(beams[i].direction, pixels[i]);
    EXPECT_EQ(beams[i].exit, Point<LidarFrame>{});
    EXPECT_FALSE(beams[i].lost);
  }
}

}  // namespace
}  // namespace landfall
