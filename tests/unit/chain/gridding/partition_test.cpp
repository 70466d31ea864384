// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <utility>
#include <vector>

#include "chain/gridding/row_partition.h"
#include "chain/gridding/tile_partition.h"

namespace landfall {
namespace {

using testing::ElementsAre;

TEST(RowPartition, KeepsPointOrderWithinABand) {
  RowPartition partition(GridSpec{1, 0, 0, 17, 1});  // rows 0-7, 8-15, 16
  const std::vector<double> y = {3, 16, 9, 0, 15.4, 99, 7.4, 7.5, -0.6};
  partition.assign(std::vector<double>(y.size(), 0.0), y);
  ASSERT_EQ(partition.band_count(), 3U);
  EXPECT_THAT(partition.points_of_band(0), ElementsAre(0, 3, 6));
  EXPECT_THAT(partition.points_of_band(1), ElementsAre(2, 4, 7));
  EXPECT_THAT(partition.points_of_band(2), ElementsAre(1));
  EXPECT_EQ(partition.outside_count(), 2U);
}

TEST(RowPartition, BandsHoldEightRows) {
  EXPECT_EQ(RowPartition(GridSpec{1, 0, 0, 7, 1}).band_count(), 1U);
  EXPECT_EQ(RowPartition(GridSpec{1, 0, 0, 8, 1}).band_count(), 1U);
  EXPECT_EQ(RowPartition(GridSpec{1, 0, 0, 9, 1}).band_count(), 2U);
}

// The row behind the last one lies in the last band's eight.
TEST(RowPartition, AnyNumberOutsideTheGridIsOutside) {
  RowPartition partition(GridSpec{1, 0, 0, 17, 1});
  partition.assign(4, [](std::size_t begin, std::size_t end, std::int32_t* rows) {
    constexpr std::int32_t kRows[] = {16, 17, -1, 99};
    std::copy(kRows + begin, kRows + end, rows);
  });
  EXPECT_THAT(partition.points_of_band(2), ElementsAre(0));
  EXPECT_THAT(partition.outside_points(), ElementsAre(1, 2, 3));
}

TEST(RowPartition, AssignForgetsThePreviousBatch) {
  RowPartition partition(GridSpec{1, 0, 0, 8, 1});
  partition.assign(std::vector<double>{0, 9}, std::vector<double>{0, 0});
  partition.assign(std::vector<double>{0}, std::vector<double>{5});
  EXPECT_THAT(partition.points_of_band(0), ElementsAre(0));
  EXPECT_EQ(partition.outside_count(), 0U);
  partition.assign({}, {});
  EXPECT_TRUE(partition.points_of_band(0).empty());
}

// More points than one piece of work holds.
TEST(RowPartition, EveryPointIsInExactlyItsBand) {
  constexpr std::size_t kPoints = 300'000;
  const GridSpec spec{0.5, -40, -40, 81, 81};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-22, 22);
  std::vector<double> x(kPoints);
  std::vector<double> y(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    x[i] = coordinate(random);
    y[i] = coordinate(random);
  }
  RowPartition partition(spec);
  partition.assign(x, y);
  std::size_t inside = 0;
  for (std::size_t band = 0; band < partition.band_count(); ++band) {
    const auto points = partition.points_of_band(band);
    inside += points.size();
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
    for (const std::uint32_t i : points) {
      const BinIndex bin = spec.bin_of(x[i], y[i]);
      ASSERT_TRUE(spec.contains(bin));
      ASSERT_EQ(static_cast<std::size_t>(bin.row) / 8, band);
    }
  }
  EXPECT_EQ(inside + partition.outside_count(), kPoints);
}

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
