// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/tile_partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

namespace landfall {
namespace {

TEST(TilePartition, HasAtLeastThePartsAskedForUpTo64) {
  const GridSpec spec = GridSpec::centered(50, 0.05);
  for (const auto& [asked, found] :
       {std::pair{1U, 1U}, {2U, 2U}, {3U, 4U}, {4U, 4U}, {33U, 64U}, {999U, 64U}})
    EXPECT_EQ(TilePartition(spec, asked).part_count(), found) << asked;
}

TEST(TilePartition, TilesAreSmallerWithMorePartsDownToABound) {
  const GridSpec spec = GridSpec::centered(50, 0.05);  // 2001 x 2001
  EXPECT_EQ(TilePartition(spec, 4).tile_side(), 256);
  EXPECT_EQ(TilePartition(spec, 16).tile_side(), 64);
  EXPECT_EQ(TilePartition(spec, 64).tile_side(), 32);
  EXPECT_EQ(TilePartition(GridSpec{1, 0, 0, 1, 1}, 64).tile_side(), 32);
}

std::size_t points_of(const TilePartition& partition, std::size_t part) {
  std::size_t count = 0;
  for (const std::uint64_t word : partition.points_of_part(part))
    count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

/// The largest part's share of the points of one line across the grid.
double largest_share(const TilePartition& partition, std::size_t points) {
  std::size_t all = 0;
  std::size_t largest = 0;
  for (std::size_t part = 0; part < partition.part_count(); ++part) {
    all += points_of(partition, part);
    largest = std::max(largest, points_of(partition, part));
  }
  EXPECT_EQ(all, points);
  return static_cast<double>(largest) / static_cast<double>(points);
}

// In several pieces of work, and again with fewer points.
TEST(TilePartition, LinesInEveryDirectionMeetAllParts) {
  TilePartition partition(GridSpec::centered(50, 0.05), 4);
  constexpr std::size_t kPoints = 40'000;
  for (const std::size_t points : {kPoints, std::size_t{999}}) {
    for (const auto& [dx, dy] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}, {1.0, 0.5}}) {
      std::vector<double> x(points);
      std::vector<double> y(points);
      for (std::size_t i = 0; i < points; ++i) {
        const double along_m = -50 + 100 * static_cast<double>(i) / static_cast<double>(points);
        x[i] = dx * along_m + 3 * dy;
        y[i] = dy * along_m + 3 * dx;
      }
      partition.assign(x, y);
      EXPECT_LE(largest_share(partition, points), 0.51) << dx << ' ' << dy;
    }
  }
}

TEST(TilePartition, NoPointsAreInNoPart) {
  TilePartition partition(GridSpec::centered(1, 0.1), 2);
  partition.assign(std::vector<double>{0}, std::vector<double>{0});
  EXPECT_EQ(points_of(partition, 0) + points_of(partition, 1), 1U);
  partition.assign({}, {});
  EXPECT_TRUE(partition.points_of_part(1).empty());
}

}  // namespace
}  // namespace landfall
