// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/receiver/echo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace landfall {
namespace {

using Ray = std::pair<double, double>;

std::size_t add(EchoRays& rays, std::vector<Ray> pixel, double gap_m) {
  std::vector<double> ranges;
  std::vector<double> signals;
  for (const auto& [range, signal] : pixel) {
    ranges.push_back(range);
    signals.push_back(signal);
  }
  return rays.add_pixel(ranges, signals, gap_m);
}

std::vector<Ray> rays_of(const EchoRays& rays, std::size_t echo) {
  std::vector<Ray> found;
  for (std::size_t j = 0; j < rays.rays_per_echo(); ++j)
    if (rays.signals_pe()[rays.index(echo, j)] > 0)
      found.emplace_back(rays.ranges_m()[rays.index(echo, j)], rays.signals_pe()[rays.index(echo, j)]);
  return found;
}

TEST(EchoRays, KeepsTheOrderWithinAShortEcho) {
  EchoRays rays;
  rays.clear(3);
  EXPECT_EQ(add(rays, {{10.1, 1}, {10, 2}, {10.05, 3}}, 0.15), 1U);
  EXPECT_EQ(rays_of(rays, 0), (std::vector<Ray>{{10.1, 1}, {10, 2}, {10.05, 3}}));
}

TEST(EchoRays, SplitsWhereNeighboursAreFarApart) {
  EchoRays rays;
  rays.clear(5);
  EXPECT_EQ(add(rays, {{12, 1}, {10, 2}, {10.1, 3}, {10.2, 4}, {11, 5}}, 0.15), 3U);
  EXPECT_EQ(rays_of(rays, 0), (std::vector<Ray>{{10, 2}, {10.1, 3}, {10.2, 4}}));
  EXPECT_EQ(rays_of(rays, 1), (std::vector<Ray>{{11, 5}}));
  EXPECT_EQ(rays_of(rays, 2), (std::vector<Ray>{{12, 1}}));
  EXPECT_EQ(rays.size(), 3U);
}

TEST(EchoRays, LeavesOutMissesAndRaysWithoutSignal) {
  EchoRays rays;
  rays.clear(4);
  EXPECT_EQ(add(rays, {{std::nan(""), 1}, {10, 0}, {10, std::nan("")}, {11, 2}}, 0.15), 1U);
  EXPECT_EQ(rays_of(rays, 0), (std::vector<Ray>{{11, 2}}));
  EXPECT_EQ(add(rays, {{std::nan(""), 1}, {10, 0}}, 0.15), 0U);
  EXPECT_EQ(rays.size(), 1U);
}

TEST(EchoRays, HoldsMoreEchoesThanABlock) {
  EchoRays rays;
  rays.clear(2);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(add(rays, {{100.0 + i, 1.0 + i}, {100.0 + i, 2.0}}, 0.1), 1U);
  for (std::size_t i = 0; i < 20; ++i) {
    const double value = static_cast<double>(i);
    EXPECT_EQ(rays_of(rays, i), (std::vector<Ray>{{100 + value, 1 + value}, {100 + value, 2}}));
  }
  rays.clear(1);
  EXPECT_EQ(rays.size(), 0U);
}

}  // namespace
}  // namespace landfall
