// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/hole_filling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/numerics/random.h"
#include "bins.h"
#include "constants.h"

namespace landfall {
namespace {

Grid<double> ramp() {
  Grid<double> z(GridSpec{1, 0, 0, 9, 11});
  for (const auto [row, col] : Bins({0, 0}, {9, 11})) z.at({row, col}) = static_cast<double>(100 * row + col);
  return z;
}

TEST(HoleFilling, ABinHasTheMeanOfTheRingAboutIt) {
  Grid<double> z = ramp();
  z.at({4, 5}) = kNan;
  const auto holes = small_holes(z, 1);
  ASSERT_EQ(holes.size(), 1U);
  EXPECT_EQ(holes[0].bin, (BinIndex{4, 5}));
  EXPECT_EQ(holes[0].ring, 1);
  fill_holes(z, holes);
  EXPECT_DOUBLE_EQ(z.at({4, 5}), 405);
}

// The middle of a block of 3 x 3 has no valid bin in its first ring; the second has 16.
TEST(HoleFilling, TheMiddleOfAHoleTakesTheSecondRingOfValidBins) {
  Grid<double> z = ramp();
  for (const BinIndex bin : Bins({3, 4}, {6, 7})) z.at(bin) = kNan;
  EXPECT_TRUE(small_holes(z, 8).empty());
  const auto holes = small_holes(z, 9);
  ASSERT_EQ(holes.size(), 9U);
  EXPECT_EQ(holes[4].ring, 2);
  fill_holes(z, holes);
  EXPECT_DOUBLE_EQ(z.at({4, 5}), 405);
  // The first corner has 5 valid bins in its ring; those filled before it do not count.
  EXPECT_DOUBLE_EQ(z.at({3, 4}), (203.0 + 204 + 205 + 303 + 403) / 5);
}

TEST(HoleFilling, HolesAtTheBorderStay) {
  for (const BinIndex bin : {BinIndex{0, 4}, BinIndex{8, 4}, BinIndex{4, 0}, BinIndex{4, 10}}) {
    Grid<double> z = ramp();
    z.at(bin) = kNan;
    EXPECT_TRUE(small_holes(z, 10).empty());
  }
  // So does a hole inside that a corner joins to the border.
  Grid<double> z = ramp();
  z.at({0, 4}) = z.at({1, 5}) = kNan;
  EXPECT_TRUE(small_holes(z, 10).empty());
  EXPECT_TRUE(small_holes(z, 0).empty());
}

TEST(HoleFilling, AHoleThatTouchesACornerOfTheMapStays) {
  const GridSpec spec{1, 0, 0, 5, 5};
  for (const BinIndex corner : {BinIndex{0, 0}, BinIndex{0, 4}, BinIndex{4, 0}, BinIndex{4, 4}}) {
    Grid<double> z(spec);
    z.at(corner) = z.at({corner.row == 0 ? 1 : 3, corner.col == 0 ? 1 : 3}) = kNan;
    EXPECT_TRUE(small_holes(z, 10).empty());
  }
}

TEST(HoleFilling, AnotherLayerIsMeanedOverTheSameRing) {
  Grid<double> z = ramp();
  Grid<double> x = ramp();
  z.at({4, 5}) = kNan;
  x.at({4, 5}) = kNan;
  x.at({3, 4}) = kNan;
  const auto holes = small_holes(z, 1);
  EXPECT_DOUBLE_EQ(ring_mean(x, holes[0]), (305.0 + 306 + 404 + 406 + 504 + 505 + 506) / 7);
}

// The middle of a block of 5 x 5 takes the third ring; of another layer, too, which has values within it.
TEST(HoleFilling, TheThirdRingHasNoBinsWithinIt) {
  Grid<double> z = ramp();
  for (const BinIndex bin : Bins({2, 3}, {7, 8})) z.at(bin) = kNan;
  const auto holes = small_holes(z, 25);
  ASSERT_EQ(holes.size(), 25U);
  EXPECT_EQ(holes[12].bin, (BinIndex{4, 5}));
  EXPECT_EQ(holes[12].ring, 3);
  Grid<double> layer = ramp();
  for (const BinIndex bin : Bins({3, 4}, {6, 7})) layer.at(bin) = 1e6;
  EXPECT_DOUBLE_EQ(ring_mean(layer, holes[12]), 405);
}

TEST(HoleFilling, AMeanOfOneValueAndOfNone) {
  Grid<double> layer(GridSpec{1, 0, 0, 3, 3}, kNan);
  EXPECT_TRUE(std::isnan(ring_mean(layer, {{1, 1}, 1})));
  layer.at({0, 2}) = 7;
  EXPECT_EQ(ring_mean(layer, {{1, 1}, 1}), 7);
}

/// As the definition says, bin by bin.
TEST(HoleFilling, EqualsBruteForceOnRandomMaps) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RandomField field(seed, RandomStream::dropout);
    Grid<double> z(GridSpec{1, 0, 0, 30, 40});
    for (std::size_t i = 0; i < z.spec().size(); ++i)
      z.values()[i] = field.uniform(2 * i) < 0.2 ? kNan : field.uniform(2 * i + 1);
    Grid<double> filled = z;
    const auto holes = small_holes(z, 6);
    fill_holes(filled, holes);
    EXPECT_GT(holes.size(), 20U);
    for (const FillableBin& hole : holes) {
      double sum = 0;
      int count = 0;
      for (std::int64_t ring = 1; count == 0; ++ring)
        for (const auto [row, col] : Bins({0, 0}, {30, 40})) {
          const auto distance = std::max(std::abs(row - hole.bin.row), std::abs(col - hole.bin.col));
          if (distance != ring || std::isnan(z.at({row, col}))) continue;
          sum += z.at({row, col});
          ++count;
        }
      EXPECT_NEAR(filled.at(hole.bin), sum / count, 1e-15);
    }
  }
}

}  // namespace
}  // namespace landfall
