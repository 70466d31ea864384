// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/posting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "bins.h"
#include "chain/gridding/convex_hull.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Points = std::vector<Horizontal>;

const auto kAll = [](double) { return true; };

struct Columns {
  explicit Columns(const Points& points) {
    for (const Horizontal& point : points) {
      x.push_back(point.x);
      y.push_back(point.y);
    }
  }
  std::vector<double> x, y;
};

std::optional<ChosenPosting> finest(const Points& points,
                                    const std::function<bool(double)>& is_allowed = kAll) {
  const Columns columns(points);
  PointOutline outline;
  const std::size_t half = columns.x.size() / 2;
  const std::span<const double> x(columns.x), y(columns.y);
  outline.add(x.first(half), y.first(half));
  outline.add(x.subspan(half), y.subspan(half));
  PostingSearch search(std::move(outline));
  search.mark(x, y);
  return search.finest(is_allowed);
}

Points lattice(double step, int count, Horizontal first = {}) {
  Points points;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < count; ++k) points.push_back({first.x + i * step, first.y + k * step});
  return points;
}

/// Bins in the hull and those without a point, by the definition.
HullBins brute_force(const Points& points, double r) {
  const Points hull = convex_hull(points);
  std::set<std::pair<std::int64_t, std::int64_t>> filled;
  std::int64_t reach = 0;
  for (const Horizontal& p : points) {
    const auto col = static_cast<std::int64_t>(std::floor(p.x / r + 0.5));
    const auto row = static_cast<std::int64_t>(std::floor(p.y / r + 0.5));
    filled.insert({row, col});
    reach = std::max({reach, std::abs(col), std::abs(row)});
  }
  HullBins bins;
  for (const auto [row, col] : Bins({-reach, -reach}, {reach + 1, reach + 1})) {
    const double x = static_cast<double>(col) * r;
    const double y = static_cast<double>(row) * r;
    bool is_inside = true;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Horizontal& a = hull[i];
      const Horizontal& b = hull[(i + 1) % hull.size()];
      is_inside = is_inside && (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) >= 0;
    }
    if (!is_inside) continue;
    ++bins.inside;
    if (!filled.contains({row, col})) ++bins.empty;
  }
  return bins;
}

TEST(ConvexHull, HasTheCornersCounterclockwise) {
  EXPECT_THAT(convex_hull({{0, 0}, {1, 0}, {0.5, 0.5}, {2, 0}, {2, 2}, {0, 2}, {0, 0}}),
              testing::ElementsAre(Horizontal{0, 0}, Horizontal{2, 0}, Horizontal{2, 2}, Horizontal{0, 2}));
  EXPECT_THAT(convex_hull({{1, 1}, {0, 0}, {2, 2}}),
              testing::ElementsAre(Horizontal{0, 0}, Horizontal{2, 2}));
  EXPECT_THAT(convex_hull({{3, 1}, {3, 1}}), testing::ElementsAre(Horizontal{3, 1}));
}

TEST(Posting, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_EQ(Posting::at_most(0.3).metres(), 0.2);
  EXPECT_EQ(Posting::at_most(0.2).metres(), 0.2);
  EXPECT_EQ(Posting::at_most(99).metres(), 50);
  EXPECT_EQ(Posting::at_most(1).metres(), 1);
  EXPECT_EQ(Posting::at_most(0.001).metres(), 0.001);
  EXPECT_EQ((Posting{5, -3}.next().metres()), 0.01);
  EXPECT_EQ((Posting{1, 2}.next().metres()), 200);
}

TEST(CellSet, HoldsCellsOnBothSidesOfTheOrigin) {
  CellSet set;
  std::set<std::pair<std::int64_t, std::int64_t>> expected;
  for (const std::int64_t row : {-65, -64, -1, 0, 63, 64, 1 << 30})
    for (const std::int64_t col :
         {-(std::int64_t{1} << 36), std::int64_t{-1}, std::int64_t{0}, std::int64_t{64}}) {
      set.insert({row, col});
      set.insert({row, col});
      expected.insert({row, col});
    }
  std::set<std::pair<std::int64_t, std::int64_t>> found;
  set.for_each([&](BinIndex cell) { EXPECT_TRUE(found.insert({cell.row, cell.col}).second); });
  EXPECT_EQ(found, expected);
}

TEST(PostingSearch, TakesTheStepOfALattice) {
  EXPECT_EQ(finest(lattice(1, 40))->posting.metres(), 1);
  EXPECT_EQ(finest(lattice(0.2, 40, {-3.93, 7.34}))->posting.metres(), 0.2);
  EXPECT_EQ(finest(lattice(0.3, 40))->posting.metres(), 0.5);
  EXPECT_EQ(finest(lattice(500, 40, {-1e4, -1e4}))->posting.metres(), 500);
  EXPECT_EQ(finest(lattice(1, 40))->bins.inside, 1600);
  EXPECT_EQ(finest(lattice(1, 40))->bins.empty, 0);
}

TEST(PostingSearch, AgreesWithBruteForce) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const double width = std::pow(10, 3 * unit(random) - 1);
    const double slant = unit(random);
    Points points;
    for (int i = 0; i < 400; ++i) {
      const double along = width * (unit(random) - 0.3);
      points.push_back({along, slant * along + 0.3 * width * unit(random)});
    }
    const auto chosen = finest(points);
    ASSERT_TRUE(chosen);
    const double r = chosen->posting.metres();
    const HullBins expected = brute_force(points, r);
    EXPECT_EQ(chosen->bins.inside, expected.inside);
    EXPECT_EQ(chosen->bins.empty, expected.empty);
    EXPECT_LE(expected.empty_share(), kMaxEmptyShare);
    for (Posting finer = Posting::at_most(r / 20); finer.metres() < r; finer = finer.next())
      EXPECT_GT(brute_force(points, finer.metres()).empty_share(), kMaxEmptyShare) << finer.metres();
  }
}

TEST(PostingSearch, TakesOnlyAnAllowedPosting) {
  const Points points = lattice(1, 40);
  EXPECT_EQ(finest(points, [](double r) { return r >= 3; })->posting.metres(), 5);
  EXPECT_EQ(finest(points, [](double) { return false; }), std::nullopt);
}

TEST(PostingSearch, PointsOnALineHaveAPosting) {
  Points line;
  for (int i = 0; i < 101; ++i) line.push_back({0.5 * i, 0});
  EXPECT_EQ(finest(line)->posting.metres(), 0.5);
  Points slanted;
  for (int i = 0; i < 101; ++i) slanted.push_back({0.5 * i, 0.31 * i + 0.1});
  EXPECT_TRUE(finest(slanted));
}

TEST(PostingSearch, FarPointsTakeNoLargeNumbersOfCells) {
  const auto chosen = finest({{1e9, 1e9}, {1e9 + 1e-3, 1e9}, {1e9, 1e9 + 1e-3}});
  EXPECT_FALSE(chosen && chosen->posting.metres() < 1e-3);
}

}  // namespace
}  // namespace landfall
