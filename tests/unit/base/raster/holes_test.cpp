// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "base/core/parallel.h"
#include "base/raster/distance_transform.h"
#include "base/raster/fill_search.h"
#include "base/raster/holes.h"
#include "base/raster/masks.h"
#include "bins.h"
#include "constants.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Numbers = std::vector<double>;
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
      for (const auto [dr, dc] : Bins({-1, -1}, {2, 2})) open.push_back({bin.row + dr, bin.col + dc});
    }
  };
  for (const auto [row, col] : bins_of(spec)) {
    if (mask.at({row, col}) == 0 || labels.at({row, col}) != 0) continue;
    ++next;
    fill({row, col});
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

Grid<std::int64_t> brute_force(const BinMask& set) {
  const GridSpec& spec = set.spec();
  Grid<std::int64_t> squared(spec, kNoValidBin);
  for (const auto [row, col] : bins_of(spec))
    for (const auto [r, c] : bins_of(spec))
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

/// Relief from 0 to 10 m in 201 steps.
std::vector<double> relief() {
  std::vector<double> values;
  for (int i = 0; i <= 2000; ++i) values.push_back(static_cast<double>(i * 7919 % 201) / 20);
  return values;
}

std::vector<double> fills_of(std::vector<double> values, const FillSearch::Stored& stored = {}) {
  FillSearch search(stored);
  search.add(values);
  std::vector<double> fills;
  for (const Fill& fill : search.result().fills) fills.push_back(fill.raw);
  std::ranges::sort(fills);
  return fills;
}

std::vector<double> with(std::vector<double> values, double value, int count = 2) {
  values.insert(values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                static_cast<std::size_t>(count), value);
  return values;
}

TEST(FillSearch, FindsARepeatedValueFartherFromTheRestThanItsRange) {
  for (const double value : {-10000.0, -99999.9, 1e10, -88888.0, -9998.0, 8888.0, -12345.0, -10.01, 20.01})
    EXPECT_EQ(fills_of(with(relief(), value)), Numbers{value});
  EXPECT_EQ(fills_of(relief()), Numbers{});
  EXPECT_EQ(fills_of(with(relief(), -10)), Numbers{}) << "at the distance of the range";
  EXPECT_EQ(fills_of(with(relief(), -88888, 1)), Numbers{}) << "a lonely value may be a peak";
}

TEST(FillSearch, NeedsSixteenOtherValues) {
  for (const int distinct : {15, 16}) {
    Numbers values;
    for (int i = 0; i < 100; ++i) values.push_back(i % distinct);
    EXPECT_EQ(fills_of(with(values, 100)), distinct == 16 ? Numbers{100} : Numbers{});
  }
}

TEST(FillSearch, FindsSeveralFills) {
  EXPECT_EQ(fills_of(with(with(relief(), -12345), -12346)), (Numbers{-12346, -12345}));
  EXPECT_EQ(fills_of(with(with(relief(), -12345), 12345)), (Numbers{-12345, 12345}));
  EXPECT_EQ(fills_of(with(with(relief(), -12345), -9999)), (Numbers{-12345, -9999}));
  EXPECT_EQ(fills_of(with(with(relief(), -12345), 50000, 1)), Numbers{-12345}) << "with a peak";
  EXPECT_EQ(fills_of(with(with(relief(), -12345), -50000, 1)), Numbers{-12345});
}

TEST(FillSearch, FindsKnownNumbersThatAreIsolated) {
  for (const int count : {1, 2}) EXPECT_EQ(fills_of(with(relief(), -9999, count)), Numbers{-9999});
  EXPECT_EQ(fills_of(with(with(relief(), -9999), -32768)), (Numbers{-32768, -9999}));
  EXPECT_EQ(fills_of(with(with(relief(), -9999), 9999)), (Numbers{-9999, 9999}));
  EXPECT_EQ(fills_of(with(relief(), -3.4e38, 1)), Numbers{-3.4e38});
  EXPECT_EQ(fills_of({-9999, -9999}), Numbers{-9999}) << "nothing else";
  Numbers deep;
  for (int i = 0; i < 3000; ++i) deep.push_back(-9990 - i % 50);
  EXPECT_EQ(fills_of(deep), Numbers{}) << "an elevation among others";
}

TEST(FillSearch, TakesALakeForTerrain) {
  Numbers valley;
  for (int i = 0; i < 5000; ++i) valley.push_back(i % 2 == 0 ? 212 : 213 + i % 40);
  EXPECT_EQ(fills_of(valley), Numbers{});
}

TEST(FillSearch, NamesTheNumberThatTheFileStores) {
  Numbers values = relief();
  for (double& value : values) value = 0.1 * std::round(value * 20) + 3;
  const FillSearch::Stored stored{.scale = 0.1, .offset = 3, .is_integer = true};
  EXPECT_EQ(fills_of(with(values, 0.1 * -3333 + 3), stored), Numbers{-3333});
  EXPECT_EQ(fills_of(with(values, 0.1 * -9999 + 3, 1), stored), Numbers{-9999});
}

TEST(FillSearch, CountsExactlyInAnyOrder) {
  std::mt19937_64 random(test_seed());
  Numbers values = with(with(relief(), -777, 13), 5000, 40);
  values.insert(values.end(), 9, kNan);
  for (int order = 0; order < 12; ++order) {
    if (order == 0) std::ranges::sort(values);
    if (order == 1) std::ranges::reverse(values);
    if (order > 1) std::ranges::shuffle(values, random);
    FillSearch search;
    search.add(values);
    const FillSearch::Result found = search.result();
    EXPECT_EQ(found.total, 2001 + 53);
    EXPECT_EQ(found.rest.low, 0);
    EXPECT_EQ(found.rest.high, 10);
    std::map<double, std::int64_t> counts;
    for (const Fill& fill : found.fills) counts[fill.value] = fill.count;
    EXPECT_EQ(counts, (std::map<double, std::int64_t>{{-777, 13}, {5000, 40}}));
  }
}

}  // namespace
}  // namespace landfall
