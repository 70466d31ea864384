// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include "base/numerics/random.h"
#include "base/raster/polygon.h"
#include "base/raster/region.h"
#include "bins.h"
#include "refusal.h"

namespace landfall {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string region_refusal(const GridSpec& dem, double radius_m) {
  return refusal([&] { return circular_region(dem, radius_m); });
}

TEST(CircularRegion, PapersCountWithoutThe28BinsOnTheCircle) {
  const GridSpec dem = GridSpec::centered(50, 0.05);
  const BinMask region = circular_region(dem, 50);
  EXPECT_EQ(count_set(region), 3'141'521);
  std::int64_t on_circle = 0;
  for (const auto [row, col] : bins_of(dem)) {
    const std::int64_t i = row - 1000;
    const std::int64_t j = col - 1000;
    if (i * i + j * j != 1'000'000) continue;
    ++on_circle;
    EXPECT_EQ(region.at({row, col}), 0);
  }
  EXPECT_EQ(on_circle, 28);
}

// R/s = 2: the origin, 4 at distance 1, 4 at sqrt 2; those at 2 are out.
TEST(CircularRegion, SmallWholeRadius) {
  const BinMask region = circular_region(GridSpec::centered(2, 1), 2);
  EXPECT_EQ(count_set(region), 9);
  EXPECT_EQ(region.at({2, 2}), 1);
  EXPECT_EQ(region.at({1, 3}), 1);
  EXPECT_EQ(region.at({0, 2}), 0);
}

TEST(CircularRegion, RatioNearAnIntegerIsThatInteger) {
  EXPECT_EQ(count_set(circular_region(GridSpec::centered(0.3, 0.1), 0.3)), 25);  // 0.3 / 0.1 < 3
  EXPECT_EQ(count_set(circular_region(GridSpec::centered(3, 1), 2 + 1e-10)), 9);
  EXPECT_EQ(count_set(circular_region(GridSpec::centered(3, 1), 2 + 1e-8)), 13);  // no longer 2
}

// (R/s)^2 = 5.29: 21 lattice points have i^2 + j^2 <= 5.
TEST(CircularRegion, FractionalRadius) {
  EXPECT_EQ(count_set(circular_region(GridSpec::centered(2, 1), 2.3)), 21);
  EXPECT_EQ(count_set(circular_region(GridSpec::centered(2, 1), 0.5)), 1);
}

TEST(CircularRegion, FitsWhileEveryBinLiesInTheDem) {
  const GridSpec dem = GridSpec::centered(2, 0.5);  // 4 bins from the origin to the border
  EXPECT_EQ(region_refusal(dem, 2.5), "accepted");  // bins at 5 would be on the circle: out
  EXPECT_EQ(region_refusal(dem, 2.6),
            "region_radius_m: 2.6 does not fit the DEM: the largest that fits is 2.5");
  EXPECT_NE(region_refusal(dem, 1e300), "accepted");
}

// 17 = 4^2 + 1 is exactly the square of the double nearest to its root: its eight bins are out.
TEST(CircularRegion, BinsOnACircleOfFractionalRadiusAreOut) {
  ASSERT_EQ(std::sqrt(17.0) * std::sqrt(17.0), 17);
  EXPECT_EQ(count_set(circular_region(GridSpec::centered(5, 1), std::sqrt(17.0))), 49);
}

// A ratio of 1e-9 is 0, which holds no bin.
TEST(CircularRegion, RefusesARadiusOfNoBin) {
  EXPECT_NE(region_refusal(GridSpec::centered(5, 1), 1e-9), "accepted");
  EXPECT_EQ(region_refusal(GridSpec::centered(5, 1), 2e-9), "accepted");
}

TEST(CircularRegion, TheOriginMayLieOnTheBorder) {
  const GridSpec dem{1, 0, -3, 5, 7};
  EXPECT_EQ(count_set(circular_region(dem, 1)), 1);
  EXPECT_EQ(region_refusal(dem, 1.12345678901234),
            "region_radius_m: 1.12345678901 does not fit the DEM: the largest that fits is 1");
  EXPECT_EQ(count_set(square_region(dem, 0.5)), 1);
}

TEST(CircularRegion, TheNearestBorderMayBeAnyOfTheFour) {
  for (const GridSpec& dem : {GridSpec{1, -2, -7, 20, 20}, GridSpec{1, -9, -2, 20, 20},
                              GridSpec{1, -9, -7, 12, 20}, GridSpec{1, -9, -7, 20, 10}}) {
    EXPECT_EQ(count_set(circular_region(dem, 3)), 25);
    EXPECT_EQ(region_refusal(dem, 3.5),
              "region_radius_m: 3.5 does not fit the DEM: the largest that fits is 3");
  }
}

TEST(CircularRegion, OriginNeedNotBeTheMiddle) {
  const GridSpec dem{1, -2, -7, 20, 20};  // the southern border is nearest
  const BinMask region = circular_region(dem, 3);
  EXPECT_EQ(count_set(region), 25);
  EXPECT_EQ(region.at({2, 7}), 1);
  EXPECT_EQ(region.at({0, 7}), 1);
  EXPECT_EQ(region_refusal(dem, 3.5),
            "region_radius_m: 3.5 does not fit the DEM: the largest that fits is 3");
}

TEST(CircularRegion, NoRegionFitsADemWithoutTheOrigin) {
  EXPECT_EQ(region_refusal({1, 1, -5, 10, 10}, 0.5),
            "region_radius_m: 0.5 does not fit the DEM, which does not hold the origin: no region fits");
}

TEST(SquareRegion, BinsWithinTheHalfWidthInclusive) {
  const BinMask region = square_region({0.1, -3, -4, 9, 9}, 0.3);  // 0.3 / 0.1 = 2.9999999999999996
  EXPECT_EQ(count_set(region), 49);
  EXPECT_EQ(region.at({0, 1}), 1);
  EXPECT_EQ(region.at({6, 7}), 1);
  EXPECT_EQ(region.at({7, 7}), 0);
  EXPECT_EQ(region.at({6, 8}), 0);
  EXPECT_EQ(count_set(square_region(GridSpec::centered(2, 1), 0.5)), 1);
}

TEST(SquareRegion, FitsWhileEveryBinLiesInTheDem) {
  const GridSpec dem = GridSpec::centered(2, 0.5);
  EXPECT_EQ(count_set(square_region(dem, 2.4)), 81);
  const auto refused = [](const GridSpec& spec, double half_width_m) {
    return refusal([&] { return square_region(spec, half_width_m); });
  };
  EXPECT_EQ(refused(dem, 2.5), "region/half_width_m: 2.5 does not fit the DEM: the largest that fits is 2");
  EXPECT_NE(refused({1, 1, -5, 10, 10}, 0.5), "accepted");
  EXPECT_NE(refused(dem, std::numeric_limits<double>::quiet_NaN()), "accepted");
  EXPECT_NE(refused(dem, -1), "accepted");
}

TEST(BinBox, HoldsTheBins) {
  const GridSpec dem = GridSpec::centered(5, 1);
  Grid<double> z(dem, std::numeric_limits<double>::quiet_NaN());
  EXPECT_LT(valid_box(z).last.row, valid_box(z).first.row);
  z.at({2, 7}) = 0;
  z.at({6, 3}) = 1;
  z.at({4, 5}) = 1;
  EXPECT_EQ(valid_box(z).first, (BinIndex{2, 3}));
  EXPECT_EQ(valid_box(z).last, (BinIndex{6, 7}));
  const BinBox circle = set_box(circular_region(dem, 3));
  EXPECT_EQ(circle.first, (BinIndex{3, 3}));  // the circle itself is not part of the region
  EXPECT_EQ(circle.last, (BinIndex{7, 7}));
}

TEST(ClippedCircle, IsTheRegionWhereTheRegionFits) {
  for (const double radius_m : {0.5, 2.0, 2.3, 2 + 1e-10, 2 + 1e-8}) {
    const BinMask whole = circular_region(GridSpec::centered(3, 1), radius_m);
    const BinMask clipped = clipped_circle(GridSpec::centered(3, 1), radius_m);
    EXPECT_TRUE(std::ranges::equal(whole.values(), clipped.values())) << radius_m;
  }
}

TEST(ClippedCircle, HasTheBinsOfAnyCircleThatLieInTheMap) {
  EXPECT_EQ(count_set(clipped_circle(GridSpec::centered(3, 1), 4.2)),
            45);  // 7 x 7 without the corners, at 18
  EXPECT_EQ(count_set(clipped_circle(GridSpec::centered(3, 1), 4.3)), 49);  // 18 < 18.49
  EXPECT_EQ(count_set(clipped_circle(GridSpec::centered(3, 1), 1e300)), 49);
  // Rows 1 .. 3 and columns -1 .. 1 of the circle of radius 2.5: (3, any) are out, so are none of the others.
  const BinMask beside =
      clipped_circle({.resolution_m = 1, .first_row = 1, .first_col = -1, .rows = 3, .cols = 3}, 2.5);
  EXPECT_EQ(count_set(beside), 6);
  EXPECT_EQ(beside.at({1, 0}), 1);
  EXPECT_EQ(beside.at({2, 1}), 0);
}

TEST(ClippedCircle, IsEmptyWhereTheMapIsElsewhere) {
  const GridSpec far{
      .resolution_m = 1, .first_row = std::int64_t{1} << 40, .first_col = 0, .rows = 2, .cols = 2};
  EXPECT_EQ(count_set(clipped_circle(far, 50)), 0);
  EXPECT_EQ(count_set(clipped_circle(far, 1e300)), 0);  // counts as 2^30 bins
}

TEST(Region, ACircleOfItsOwnCentre) {
  const GridSpec dem{.resolution_m = 0.5, .first_row = -20, .first_col = -10, .rows = 50, .cols = 41};
  for (const Horizontal center : {Horizontal{2, 3}, Horizontal{1.3, -0.8}, Horizontal{2.25, 2}})
    for (const double radius_m : {3.0, 2.9, 0.7}) {
      const BinMask found = circular_region(dem, radius_m, center);
      EXPECT_TRUE(std::ranges::equal(found.values(), clipped_circle(dem, radius_m, center).values()));
      for (const auto [row, col] : bins_of(dem)) {
        const double distance = std::hypot(dem.x(col) - center.x, dem.y(row) - center.y);
        if (std::abs(distance - radius_m) <= 1e-9) continue;
        ASSERT_EQ(found.at({row, col}) != 0, distance < radius_m) << row << " " << col;
      }
    }
  EXPECT_EQ(count_set(circular_region(dem, 1.5, {2, 3})), count_set(circular_region(dem, 1.5)));
  const auto refused = [&](double radius_m, Horizontal center) {
    return refusal([&] { return circular_region(dem, radius_m, center); });
  };
  EXPECT_EQ(refused(5.5, {0, 0}), "accepted");
  EXPECT_EQ(refused(4.5, {-1, 0}), "accepted");
  EXPECT_EQ(refused(5, {-1, 0}),
            "region_radius_m: 5 does not fit the DEM: the largest that fits there is 4.5");
  EXPECT_EQ(refused(1, {-6, 0}),
            "region_radius_m: 1 does not fit the DEM, which does not hold the centre: no region fits there");
}

const Polygon::Ring kSquare = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};

std::string refusal_of(const std::vector<Polygon::Ring>& rings) {
  return refusal([&] { require_simple(Polygon(rings), "a.geojson"); });
}

/// The sum of the angles under which the edges of a ring are seen, in turns: an oracle apart from the rays of
/// Polygon::contains().
int winding_number(const Polygon::Ring& ring, Horizontal place) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Horizontal a{ring[i].x - place.x, ring[i].y - place.y};
    const Horizontal& next = ring[(i + 1) % ring.size()];
    const Horizontal b{next.x - place.x, next.y - place.y};
    sum += std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
  }
  return static_cast<int>(std::lround(sum / (2 * std::numbers::pi)));
}

/// A star-shaped ring about a centre, which never crosses itself.
Polygon::Ring star(Horizontal centre, double size_m, std::uint64_t seed) {
  Polygon::Ring ring;
  constexpr int kVertices = 23;
  const RandomField random(1, RandomStream::variation);
  for (int k = 0; k < kVertices; ++k) {
    const double radius = size_m * (0.3 + 0.7 * random.uniform(seed, static_cast<std::uint64_t>(k)));
    const double angle = 2 * std::numbers::pi * k / kVertices;
    ring.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return ring;
}

TEST(PolygonRegion, TheBinsInsideAreThoseThatItsRingsWindAround) {
  const GridSpec dem{.resolution_m = 0.1, .first_row = -60, .first_col = -40, .rows = 90, .cols = 110};
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Polygon::Ring outer = star({1, -1.5}, 4, seed);
    const Polygon::Ring hole = star({1, -1.5}, 1, seed + 100);
    const Polygon::Ring apart = star({5, 1}, 1.5, seed + 200);
    const BinMask found = clipped_polygons(dem, {Polygon({outer, hole}), Polygon({apart})});
    for (const auto [row, col] : bins_of(dem)) {
      const Horizontal place{dem.x(col), dem.y(row)};
      const bool is_inside = (winding_number(outer, place) != 0 && winding_number(hole, place) == 0) ||
                             winding_number(apart, place) != 0;
      ASSERT_EQ(found.at({row, col}) != 0, is_inside) << seed << " " << place.x << " " << place.y;
    }
  }
}

TEST(PolygonRegion, TheBorderBelongsToTheRegion) {
  const GridSpec dem = GridSpec::centered(6, 1);
  EXPECT_EQ(count_set(polygon_region(dem, {Polygon({kSquare})}, "p")), 25);
  EXPECT_EQ(count_set(polygon_region(dem, {Polygon({kSquare, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}})}, "p")), 24);
  const Polygon overlapping({{{2, 2}, {6, 2}, {6, 6}, {2, 6}}});
  EXPECT_EQ(count_set(polygon_region(dem, {Polygon({kSquare}), overlapping}, "p")), 25 + 25 - 9);
}

TEST(PolygonRegion, ARegionOutsideTheMapIsRefusedAndNoBinToo) {
  const GridSpec dem = GridSpec::centered(3, 1);
  const auto region = [&](const Polygon::Ring& ring) {
    return refusal([&] { return polygon_region(dem, {Polygon({ring})}, "a.geojson"); });
  };
  EXPECT_EQ(region({{-3.5, -3.5}, {3.5, -3.5}, {0, 3.5}}), "accepted");
  EXPECT_THAT(region(kSquare), AllOf(HasSubstr("a.geojson: the polygon reaches beyond the map: x 0 to 4"),
                                     HasSubstr("covers x -3.5 to 3.5")));
  EXPECT_THAT(region({{10, 10}, {11, 10}, {10, 11}}), HasSubstr("beyond the map"));
  EXPECT_THAT(region({{0.2, 0.2}, {0.8, 0.2}, {0.5, 0.8}}), HasSubstr("no centre of a bin"));
  EXPECT_EQ(count_set(clipped_polygons(dem, {Polygon({kSquare})})), 16);
  EXPECT_EQ(count_set(clipped_polygons(dem, {Polygon({{{10, 10}, {11, 10}, {10, 11}}})})), 0);
}

TEST(PolygonRegion, EmptyAndCrossingPolygonsAreRefused) {
  EXPECT_EQ(refusal_of({kSquare}), "accepted");
  EXPECT_EQ(refusal_of({kSquare, {{0, 0}, {2, 1}, {1, 2}}}), "accepted");  // a hole that touches the border
  EXPECT_EQ(refusal_of({{{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}}), "accepted");  // touches itself
  EXPECT_THAT(refusal_of({{}}), HasSubstr("empty"));
  EXPECT_THAT(refusal_of({{{0, 0}, {1, 1}}}), HasSubstr("empty"));
  EXPECT_THAT(refusal_of({{{0, 0}, {1, 1}, {2, 2}}}), HasSubstr("without area"));
  EXPECT_THAT(refusal_of({{{0, 0}, {4, 4}, {4, 0}, {0, 3}}}),
              AllOf(HasSubstr("a.geojson: the polygon crosses itself"), HasSubstr("(0, 0) m to (4, 4) m")));
  EXPECT_THAT(refusal_of({kSquare, {{3, 1}, {5, 1}, {5, 2}, {3, 2}}}), HasSubstr("crosses itself"));
  EXPECT_THAT(refusal_of({{{0, 0}, {4, 0}, {NAN, 4}}}), HasSubstr("not a finite number"));
  EXPECT_THAT(refusal_of({{{0, 0}, {1e308, 0}, {0, 1e308}}}),
              HasSubstr("a vertex at 1e+308, 0 m, farther out than the 1e9 m of a frame"));
}

}  // namespace
}  // namespace landfall
