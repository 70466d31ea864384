// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/raster/masks.h"

namespace landfall {
namespace {

using testing_masks::drawn;
using testing_masks::random_mask;

// The obvious oracle: flood fill from each unlabelled bin, in row-major order.
Grid<std::int32_t> flood_fill_labels(const BinMask& mask) {
  const GridSpec& spec = mask.spec();
  Grid<std::int32_t> labels(spec);
  std::int32_t next = 0;
  const auto fill = [&](BinIndex seed) {
    std::vector<BinIndex> open{seed};
    while (!open.empty()) {
      const BinIndex bin = open.back();
      open.pop_back();
      if (!spec.contains(bin) || mask.at(bin) == 0 || labels.at(bin) != 0) continue;
      labels.at(bin) = next;
      for (std::int64_t dr = -1; dr <= 1; ++dr)
        for (std::int64_t dc = -1; dc <= 1; ++dc) open.push_back({bin.row + dr, bin.col + dc});
    }
  };
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      if (mask.at({row, col}) == 0 || labels.at({row, col}) != 0) continue;
      ++next;
      fill({row, col});
    }
  }
  return labels;
}

TEST(LabelHoles, NoHole) {
  const HoleLabels labels = label_holes(drawn({"...", "..."}));
  EXPECT_TRUE(labels.holes.empty());
  EXPECT_EQ(std::count(labels.id.values().begin(), labels.id.values().end(), 0), 6);
}

TEST(LabelHoles, CornersConnect) {
  EXPECT_EQ(label_holes(drawn({"..#", ".#.", "#.."})).holes.size(), 1U);
  EXPECT_EQ(label_holes(drawn({"#..", ".#.", "..#"})).holes.size(), 1U);
  EXPECT_EQ(label_holes(drawn({"#.#", "...", "#.#"})).holes.size(), 4U);
}

// The border does not wrap: the last bin of a row and the first of the next are apart.
TEST(LabelHoles, RowsDoNotWrap) { EXPECT_EQ(label_holes(drawn({"#...", "...#"})).holes.size(), 2U); }

TEST(LabelHoles, NumberedByFirstBinFromTheSouth) {
  const HoleLabels labels = label_holes(drawn({"#..#", "#...", "#..#", "...#"}));
  ASSERT_EQ(labels.holes.size(), 3U);
  EXPECT_EQ(labels.id.at({0, 3}), 1);
  EXPECT_EQ(labels.id.at({1, 0}), 2);
  EXPECT_EQ(labels.id.at({3, 0}), 2);
  EXPECT_EQ(labels.id.at({3, 3}), 3);
  EXPECT_EQ(labels.holes[1].size_bins, 3);
  EXPECT_EQ(labels.holes[1].first, (BinIndex{1, 0}));
}

// Two arms that meet only in the last row take the number of the first arm.
TEST(LabelHoles, LateUnionKeepsTheFirstBin) {
  const HoleLabels labels = label_holes(drawn({"#####", "#.#.#", "#.#.#"}));
  ASSERT_EQ(labels.holes.size(), 1U);
  EXPECT_EQ(labels.holes[0].first, (BinIndex{0, 0}));
  EXPECT_EQ(labels.holes[0].size_bins, 11);
  EXPECT_EQ(labels.id.at({0, 4}), 1);
}

TEST(LabelHoles, DescribesAnLShape) {
  BinMask mask(GridSpec{0.5, -2, -3, 5, 7});
  for (const BinIndex bin : {BinIndex{1, 2}, BinIndex{1, 3}, BinIndex{1, 4}, BinIndex{2, 2}})
    mask.at(bin) = 1;
  const std::vector<Hole> holes = label_holes(mask).holes;
  ASSERT_EQ(holes.size(), 1U);
  EXPECT_EQ(holes[0].id, 1);
  EXPECT_EQ(holes[0].size_bins, 4);
  EXPECT_EQ(holes[0].first, (BinIndex{1, 2}));
  EXPECT_EQ(holes[0].south_west, (BinIndex{1, 2}));
  EXPECT_EQ(holes[0].north_east, (BinIndex{2, 4}));
  EXPECT_EQ(holes[0].centroid_x_m, (-3 + 2.75) * 0.5);
  EXPECT_EQ(holes[0].centroid_y_m, (-2 + 1.25) * 0.5);
}

// The second row begins west of the first.
TEST(LabelHoles, TheBoxGrowsToTheWest) {
  const HoleLabels labels = label_holes(drawn({"##.#", ".##.", "..#."}));
  ASSERT_EQ(labels.holes.size(), 1U);
  EXPECT_EQ(labels.holes[0].first, (BinIndex{0, 2}));
  EXPECT_EQ(labels.holes[0].south_west, (BinIndex{0, 0}));
  EXPECT_EQ(labels.holes[0].north_east, (BinIndex{2, 3}));
  EXPECT_EQ(labels.holes[0].depth_bins, 0);  // not filled here
}

TEST(LabelHoles, EqualsFloodFillOnRandomMasks) {
  for (const double set_frac : {0.1, 0.3, 0.4, 0.5, 0.7, 1.0}) {
    for (const GridSpec& spec :
         {GridSpec{1, 0, 0, 40, 53}, GridSpec{1, 0, 0, 1, 60}, GridSpec{1, 0, 0, 60, 1}}) {
      const BinMask mask = random_mask(spec, set_frac, 7);
      const Grid<std::int32_t> expected = flood_fill_labels(mask);
      const HoleLabels actual = label_holes(mask);
      EXPECT_TRUE(std::ranges::equal(actual.id.values(), expected.values())) << set_frac;
      for (const Hole& hole : actual.holes)
        EXPECT_EQ(hole.size_bins, std::count(expected.values().begin(), expected.values().end(), hole.id));
    }
  }
}

}  // namespace
}  // namespace landfall
