// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/polygon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/numerics/random.h"
#include "refusal.h"

namespace landfall {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

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
    for (std::int64_t row = 0; row < dem.rows; ++row)
      for (std::int64_t col = 0; col < dem.cols; ++col) {
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
