// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/row_partition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

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

}  // namespace
}  // namespace landfall
