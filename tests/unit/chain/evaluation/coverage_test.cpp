// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "base/raster/masks.h"
#include "constants.h"

namespace landfall {
namespace {

using testing_masks::drawn;

BinMask all_but(const BinMask& empty) {
  BinMask valid(empty.spec());
  for (std::size_t i = 0; i < empty.spec().size(); ++i) valid.values()[i] = empty.values()[i] != 0 ? 0 : 1;
  return valid;
}

/// The region is the whole drawing.
Coverage coverage_of(std::initializer_list<std::string_view> drawing) {
  const BinMask empty = drawn(drawing);
  return assess_coverage(all_but(empty), BinMask(empty.spec(), 1), {});
}

TEST(Coverage, ABinIsValidIfItHasAnElevation) {
  Grid<double> z({1, 0, 0, 1, 4}, 1.5);
  z.values()[1] = kNan;
  z.values()[2] = 0;
  const BinMask valid = valid_bins(z);
  EXPECT_TRUE(std::ranges::equal(valid.values(), std::vector<std::int8_t>{1, 0, 1, 1}));
}

TEST(Coverage, FullDem) {
  const CoverageMetrics metrics = coverage_of({"...", "..."}).metrics;
  EXPECT_EQ(metrics, CoverageMetrics{});
}

TEST(Coverage, TwoByTwoHoleIsOneBinFromValid) {
  const Coverage coverage = coverage_of({"....", ".##.", ".##.", "...."});
  EXPECT_EQ(coverage.metrics.invalid_count, 4);
  EXPECT_EQ(coverage.metrics.invalid_frac, 0.25);
  EXPECT_EQ(coverage.metrics.max_distance_bins, 1);
  EXPECT_EQ(coverage.metrics.distance_over_limit_count, 0);
}

TEST(Coverage, ThreeByThreeHoleIsTwoBinsAtTheCentre) {
  const Coverage coverage = coverage_of({".....", ".###.", ".###.", ".###.", "....."});
  EXPECT_EQ(coverage.metrics.max_distance_bins, 2);
  EXPECT_EQ(coverage.metrics.distance_over_limit_count, 1);
  EXPECT_EQ(coverage.squared_distance.at({2, 2}), 4);
  EXPECT_EQ(coverage.squared_distance.at({1, 1}), 1);
}

TEST(Coverage, PlusShapedHoleIsRootTwoAtTheCentre) {
  const Coverage coverage = coverage_of({".....", "..#..", ".###.", "..#..", "....."});
  EXPECT_EQ(coverage.metrics.max_distance_bins, std::sqrt(2.0));
  EXPECT_EQ(coverage.metrics.distance_over_limit_count, 1);
}

// At the DEM's border no valid bin lies beyond: a 3 x 3 hole in the corner is 3 bins deep.
TEST(Coverage, HoleAtTheDemBorder) {
  const Coverage coverage = coverage_of({".....", "###..", "###..", "###.."});
  EXPECT_EQ(coverage.metrics.max_distance_bins, 3);
  EXPECT_EQ(coverage.squared_distance.at({0, 0}), 9);
  EXPECT_EQ(coverage.holes[0].depth_bins, 3);
}

// Only the region's bins make the hole; valid bins outside the region count for its distance, and invalid
// ones outside it do not join two holes.
TEST(Coverage, HoleAtTheRegionBorder) {
  const BinMask valid = all_but(drawn({"......", ".####.", ".#..#.", "......"}));
  const BinMask region = drawn({"......", ".#..#.", "####.#", "######"});
  const Coverage coverage = assess_coverage(valid, region, {});
  EXPECT_EQ(coverage.metrics.invalid_count, 3);
  ASSERT_EQ(coverage.holes.size(), 2U);
  EXPECT_EQ(coverage.holes[0].size_bins, 2);
  EXPECT_EQ(coverage.holes[1].first, (BinIndex{2, 4}));
  EXPECT_EQ(coverage.metrics.max_distance_bins, 1);
  EXPECT_EQ(coverage.invalid.at({2, 2}), 0);
  EXPECT_EQ(coverage.squared_distance.at({2, 2}), 1);  // the layer covers the DEM
  EXPECT_EQ(coverage.metrics.invalid_frac, 3.0 / 13);
}

TEST(Coverage, NoValidBinIsInfinitelyFar) {
  const Coverage coverage = coverage_of({"###", "###"});
  EXPECT_EQ(coverage.metrics.invalid_frac, 1);
  EXPECT_EQ(coverage.metrics.max_distance_bins, kInfinity);
  EXPECT_EQ(coverage.metrics.distance_over_limit_count, 6);
  EXPECT_EQ(coverage.holes[0].depth_bins, kInfinity);
}

TEST(Coverage, HistogramAndHolesOverTheLimit) {
  const BinMask empty = drawn({"#.#.##", "......", "####.#"});
  const Coverage coverage = assess_coverage(all_but(empty), BinMask(empty.spec(), 1), {.hole_size = 2});
  EXPECT_EQ(coverage.metrics.hole_count, 5);
  EXPECT_EQ(coverage.metrics.largest_hole_bins, 4);
  EXPECT_EQ(coverage.metrics.holes_over_limit, 1);  // a hole of 2 is not over
  EXPECT_EQ(coverage.metrics.hole_size_histogram.size_bins, (std::vector<std::int64_t>{1, 2, 4}));
  EXPECT_EQ(coverage.metrics.hole_size_histogram.count, (std::vector<std::int64_t>{3, 1, 1}));
}

}  // namespace
}  // namespace landfall
