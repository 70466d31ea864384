// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/ray/windowed_terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "bins.h"
#include "chain/ray/heightfield_engine.h"

namespace landfall {
namespace {

/// 0.37 m apart: places in cells are rounded numbers. Relief of some metres, with holes.
constexpr GridSpec kGrid{0.37, -530, -400, 1101, 901};

double relief_m(double x_m, double y_m) {
  return 4 * std::sin(0.13 * x_m) * std::cos(0.11 * y_m) + 0.3 * std::sin(2.1 * x_m + 1.7 * y_m);
}

Grid<double> nodes_of(const GridSpec& window) {
  Grid<double> z(window);
  for (const auto [r, c] : bins_of(window)) {
    const std::int64_t row = window.first_row + r;
    const std::int64_t col = window.first_col + c;
    z.at({r, c}) = (row * 31 + col * 17) % 1009 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                     : relief_m(window.x(c), window.y(r));
  }
  return z;
}

struct Loads {
  std::vector<GridSpec> windows;
};

LargeTerrain large(Loads& loads) {
  const auto load = [&loads](const GridSpec& window) {
    loads.windows.push_back(window);
    return nodes_of(window);
  };
  return {kGrid, -4.4, 4.4, {64, 64}, load};
}

EngineMaker heightfield() {
  return [](std::shared_ptr<const TriangulatedGrid> surface) {
    return make_heightfield_engine(std::move(surface));
  };
}

std::shared_ptr<const TriangulatedGrid> whole_surface(const CellOrigin& origin) {
  return std::make_shared<const TriangulatedGrid>(nodes_of(kGrid), origin);
}

Ray ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return {Point<DemFrame>{from}, Direction<DemFrame>::of({to - from})};
}

/// Rays from above to places within `reach_m` of a point; every tenth starts between the hills and goes
/// anywhere.
std::vector<Ray> rays_around(double x_m, double y_m, double reach_m, std::uint64_t seed) {
  const RandomField random(seed, RandomStream::disturbance);
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const auto within = [&](std::uint64_t j, double half) { return half * (2 * random.uniform(i, j) - 1); };
    const Eigen::Vector3d to(x_m + within(0, reach_m), y_m + within(1, reach_m), within(2, 3));
    const Eigen::Vector3d from =
        i % 10 == 0 ? Eigen::Vector3d(to.x() + within(3, 20), to.y() + within(4, 20), 4.2)
                    : Eigen::Vector3d(x_m + within(3, 60), y_m + within(4, 60), 90 + within(5, 40));
    rays.push_back(ray(from, to));
  }
  return rays;
}

bool same_ranges(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b,
                            [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

/// By calls for 100 rays each.
std::vector<double> ranges_of_calls(const RayEngine& engine, const std::vector<Ray>& rays) {
  std::vector<double> ranges(rays.size());
  for (std::size_t i = 0; i < rays.size(); i += 100)
    engine.first_hits(std::span(rays).subspan(i, 100), std::span(ranges).subspan(i, 100));
  return ranges;
}

TEST(WindowedTerrain, AnswersAreThoseOfTheWholeTerrainBitForBit) {
  const CellOrigin origin = CellOrigin::of_windows(kGrid, 4.4);
  const auto whole = make_heightfield_engine(whole_surface(origin));
  const auto plain = make_heightfield_engine(whole_surface({}));
  const std::vector<std::array<double, 2>> places = {{0, 0}, {-120, -170}, {150, 190}, {-146, 100}};
  for (std::size_t p = 0; p < places.size(); ++p) {
    const auto rays = rays_around(places[p][0], places[p][1], 12, p);
    Loads loads;
    const WindowedTerrain window(large(loads), heightfield());
    const std::vector<double> answers = ranges_of_calls(window, rays);
    const std::vector<double> expected = ranges_of_calls(*whole, rays);
    EXPECT_TRUE(same_ranges(answers, expected)) << p;
    EXPECT_GT(std::ranges::count_if(answers, [](double r) { return std::isfinite(r); }), 1500) << p;
    const std::vector<double> ordinary = ranges_of_calls(*plain, rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (std::isfinite(ordinary[i])) {
        ASSERT_NEAR(answers[i], ordinary[i], 1e-9) << i;
      }
    EXPECT_LE(loads.windows.size(), 6U) << p;
  }
}

TEST(WindowedTerrain, AWindowIsAPartAndGrows) {
  Loads loads;
  const WindowedTerrain terrain(large(loads), heightfield());
  EXPECT_EQ(terrain.window().size(), 0U);
  std::vector<double> ranges(1);
  terrain.first_hits(std::vector{ray({0, 0, 50}, {1, 1, 0})}, ranges);
  const std::size_t first = terrain.window().size();
  EXPECT_LE(first, 192U * 192U);
  terrain.first_hits(std::vector{ray({30, 0, 50}, {60, 1, 0})}, ranges);
  EXPECT_GT(terrain.window().size(), first);
  EXPECT_LT(terrain.window().size(), kGrid.size() / 2);
  for (const GridSpec& window : loads.windows) {
    EXPECT_EQ((window.first_row - kGrid.first_row) % 64, 0);
    EXPECT_EQ((window.first_col - kGrid.first_col) % 64, 0);
  }
}

// Level rays between the hills may hit anywhere.
TEST(WindowedTerrain, LevelRaysTakeTheWholeTerrain) {
  Loads loads;
  const WindowedTerrain terrain(large(loads), heightfield());
  std::vector<double> ranges(1);
  terrain.first_hits(std::vector{ray({0, 0, 4.35}, {1, 0.2, 4.35})}, ranges);
  std::vector<double> expected(1);
  make_heightfield_engine(whole_surface(CellOrigin::of_windows(kGrid, 4.4)))
      ->first_hits(std::vector{ray({0, 0, 4.35}, {1, 0.2, 4.35})}, expected);
  EXPECT_TRUE(same_ranges(ranges, expected));
}

TEST(WindowedTerrain, RaysThatNeedNoGroundLoadNothing) {
  Loads loads;
  const WindowedTerrain terrain(large(loads), heightfield());
  std::vector<double> ranges(2, 1);
  terrain.first_hits(std::vector{ray({0, 0, 50}, {0, 0, 60}), ray({0, 0, 50}, {1, 0, 50})}, ranges);
  EXPECT_TRUE(std::isnan(ranges[0]) && std::isnan(ranges[1]));
  EXPECT_TRUE(std::isnan(terrain.elevation(1e5, 0)));
  EXPECT_TRUE(loads.windows.empty());
  EXPECT_EQ(terrain.highest_m(), 4.4);
}

TEST(WindowedTerrain, ElevationsAndNormalsAreThoseOfTheWhole) {
  Loads loads;
  const WindowedTerrain terrain(large(loads), {});
  const auto whole = whole_surface(CellOrigin::of_windows(kGrid, 4.4));
  const RandomField random(3, RandomStream::disturbance);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const double x_m = -40 + 10 * random.uniform(i, 0) + 0.02 * static_cast<double>(i);
    const double y_m = 100 * random.uniform(i, 1);
    const double expected = whole->elevation(x_m, y_m);
    const double z_m = terrain.elevation(x_m, y_m);
    ASSERT_TRUE(z_m == expected || (std::isnan(z_m) && std::isnan(expected))) << x_m << ' ' << y_m;
    if (std::isnan(z_m)) continue;
    ASSERT_EQ(terrain.normal({x_m, y_m, z_m}), whole->normal({x_m, y_m, z_m}));
  }
  EXPECT_LT(terrain.window().size(), kGrid.size());
}

TEST(WindowedTerrain, ManyThreadsGrowIt) {
  const auto rays = rays_around(10, 10, 80, 9);
  Loads loads;
  const WindowedTerrain terrain(large(loads), heightfield());
  std::vector<double> answers(rays.size());
  parallel_for(rays.size(), 50, [&](std::size_t begin, std::size_t end) {
    terrain.first_hits(std::span(rays).subspan(begin, end - begin),
                       std::span(answers).subspan(begin, end - begin));
  });
  const auto whole = make_heightfield_engine(whole_surface(CellOrigin::of_windows(kGrid, 4.4)));
  EXPECT_TRUE(same_ranges(answers, ranges_of_calls(*whole, rays)));
}

TEST(WindowedTerrain, RefusesATerrainFarFromItsOrigin) {
  Loads loads;
  LargeTerrain far = large(loads);
  far.spec.first_col = 40000;
  EXPECT_THROW(WindowedTerrain(far, {}), UsageError);
}

}  // namespace
}  // namespace landfall
