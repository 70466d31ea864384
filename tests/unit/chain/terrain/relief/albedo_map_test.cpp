// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/albedo_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"

namespace landfall {
namespace {

constexpr GridSpec kNodes{0.5, -5, -3, 10, 7};

float albedo_of(double x_m, double y_m) { return static_cast<float>(0.5 + 0.01 * x_m + 0.1 * y_m); }

/// Loads albedo_of() at the nodes, and records the windows.
AlbedoMap map_of(std::vector<GridSpec>& windows, const BinIndex& tile) {
  return {kNodes, tile, [&windows](const GridSpec& window) {
            windows.push_back(window);
            Grid<float> nodes(window);
            for (std::int64_t row = 0; row < window.rows; ++row)
              for (std::int64_t col = 0; col < window.cols; ++col)
                nodes.at({row, col}) = albedo_of(window.x(col), window.y(row));
            return nodes;
          }};
}

TEST(AlbedoMap, IsThatOfTheNearestNode) {
  for (const BinIndex& tile : {BinIndex{4, 3}, BinIndex{1, 1}, BinIndex{256, 256}}) {
    std::vector<GridSpec> windows;
    const AlbedoMap map = map_of(windows, tile);
    for (std::int64_t row = 0; row < kNodes.rows; ++row)
      for (std::int64_t col = 0; col < kNodes.cols; ++col)
        for (const double off_m : {-0.24, 0.0, 0.24})
          EXPECT_EQ(map.at(kNodes.x(col) + off_m, kNodes.y(row) - off_m),
                    static_cast<double>(albedo_of(kNodes.x(col), kNodes.y(row))));
  }
}

TEST(AlbedoMap, LoadsATileOnceAndOnlyIfNeeded) {
  std::vector<GridSpec> windows;
  const AlbedoMap map = map_of(windows, {4, 3});
  EXPECT_TRUE(windows.empty());
  static_cast<void>(map.at(-1.5, -2.5));
  static_cast<void>(map.at(-0.5, -1));
  EXPECT_EQ(windows, (std::vector<GridSpec>{{0.5, -5, -3, 4, 3}}));
  static_cast<void>(map.at(1.5, 2));
  EXPECT_EQ(windows.back(), (GridSpec{0.5, 3, 3, 2, 1}));
  EXPECT_EQ(windows.size(), 2);
}

TEST(AlbedoMap, OffTheTerrainThereIsNone) {
  std::vector<GridSpec> windows;
  const AlbedoMap map = map_of(windows, {4, 3});
  for (const auto& [x_m, y_m] : {std::pair{-1.76, 0.0}, {1.76, 0.0}, {0.0, -2.76}, {0.0, 2.26}, {NAN, 0.0}})
    EXPECT_TRUE(std::isnan(map.at(x_m, y_m)));
  EXPECT_TRUE(windows.empty());
}

TEST(AlbedoMap, AnyThreadMayAsk) {
  std::vector<GridSpec> windows;
  const AlbedoMap map = map_of(windows, {1, 1});
  parallel_for(10000, 7, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto node = static_cast<std::int64_t>((i * 37) % kNodes.size());
      const double x_m = kNodes.x(node % kNodes.cols);
      const double y_m = kNodes.y(node / kNodes.cols);
      ASSERT_EQ(map.at(x_m, y_m), static_cast<double>(albedo_of(x_m, y_m)));
    }
  });
  EXPECT_EQ(windows.size(), kNodes.size());
}

TEST(AlbedoMap, PassesTheLoadersErrorOn) {
  const AlbedoMap map(kNodes, {4, 3}, [](const GridSpec&) -> Grid<float> { throw FormatError("bad"); });
  EXPECT_THROW(static_cast<void>(map.at(0, 0)), FormatError);
  EXPECT_THROW(static_cast<void>(map.at(0, 0)), FormatError);
}

}  // namespace
}  // namespace landfall
