// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/distance_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/parallel.h"
#include "base/raster/masks.h"

namespace landfall {
namespace {

using testing_masks::drawn;
using testing_masks::random_mask;

Grid<std::int64_t> brute_force(const BinMask& set) {
  const GridSpec& spec = set.spec();
  Grid<std::int64_t> squared(spec, kNoValidBin);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col)
      for (std::int64_t r = 0; r < spec.rows; ++r)
        for (std::int64_t c = 0; c < spec.cols; ++c)
          if (set.at({r, c}) != 0)
            squared.at({row, col}) =
                std::min(squared.at({row, col}), (r - row) * (r - row) + (c - col) * (c - col));
  return squared;
}

TEST(SquaredDistance, OneSetBin) {
  const Grid<std::int64_t> squared = squared_distance(drawn({"....", "#...", "...."}));
  EXPECT_EQ(squared.at({1, 0}), 0);
  EXPECT_EQ(squared.at({1, 3}), 9);
  EXPECT_EQ(squared.at({0, 2}), 5);
  EXPECT_EQ(squared.at({2, 3}), 10);
}

TEST(SquaredDistance, NoSetBinIsNoDistance) {
  const Grid<std::int64_t> squared = squared_distance(BinMask(GridSpec{1, 0, 0, 3, 5}));
  EXPECT_TRUE(std::ranges::all_of(squared.values(), [](std::int64_t d) { return d == kNoValidBin; }));
  EXPECT_EQ(bins_apart(kNoValidBin), std::numeric_limits<double>::infinity());
}

TEST(SquaredDistance, FarthestCorner) {
  BinMask set(GridSpec{1, 0, 0, 300, 7});
  set.at({0, 0}) = 1;
  EXPECT_EQ(squared_distance(set).at({299, 6}), 299 * 299 + 36);
}

TEST(SquaredDistance, OneBin) {
  EXPECT_EQ(squared_distance(drawn({"#"})).at({0, 0}), 0);
  EXPECT_EQ(squared_distance(drawn({"."})).at({0, 0}), kNoValidBin);
}

TEST(SquaredDistance, SmallMasksEqualBruteForce) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const BinMask set = random_mask(GridSpec{1, 0, 0, 9, 13}, 0.01 * static_cast<double>(1 + seed), seed);
    EXPECT_TRUE(std::ranges::equal(squared_distance(set).values(), brute_force(set).values())) << seed;
  }
}

TEST(SquaredDistance, EmptyGrid) {
  EXPECT_TRUE(squared_distance(BinMask(GridSpec{1, 0, 0, 0, 0})).values().empty());
}

TEST(SquaredDistance, EqualsBruteForceOnRandomMasks) {
  for (const double set_frac : {0.002, 0.02, 0.2, 0.9}) {
    for (const GridSpec& spec : {GridSpec{1, 0, 0, 37, 70}, GridSpec{1, 0, 0, 70, 23},
                                 GridSpec{1, 0, 0, 1, 90}, GridSpec{1, 0, 0, 90, 1}}) {
      const BinMask set = random_mask(spec, set_frac, 11);
      for (const std::size_t threads : {1U, 2U}) {
        const ThreadLimit limit(threads);
        EXPECT_TRUE(std::ranges::equal(squared_distance(set).values(), brute_force(set).values()))
            << set_frac << ' ' << spec.rows << " x " << spec.cols << ", threads " << threads;
      }
    }
  }
}

TEST(DistanceBins, IsTheRoot) {
  EXPECT_EQ(bins_apart(0), 0);
  EXPECT_EQ(bins_apart(4), 2);
  EXPECT_EQ(bins_apart(2), std::sqrt(2.0));
}

}  // namespace
}  // namespace landfall
