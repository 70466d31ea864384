// SPDX-License-Identifier: GPL-3.0-or-later
// The answers that each engine must give, in closed form; every test runs on every engine.
#include "chain/ray/engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

#include "base/numerics/exact_arithmetic.h"
#include "brute_force.h"
#include "chain/ray/cgal_engine.h"
#include "chain/ray/heightfield_engine.h"
#include "scenes.h"

namespace landfall {
namespace {

struct TestedEngine {
  const char* name;
  std::unique_ptr<RayEngine> (*make)(Terrain);
};

class Engine : public testing::TestWithParam<TestedEngine> {
 protected:
  [[nodiscard]] static double range(const Terrain& terrain, const Ray& ray) {
    return ranges_of(*GetParam().make(terrain), {ray}).front();
  }
};

INSTANTIATE_TEST_SUITE_P(
    All, Engine,
    testing::Values(TestedEngine{"brute_force", make_brute_force_engine<TriangulatedGrid>},
                    TestedEngine{"cgal", make_cgal}, TestedEngine{"heightfield", make_heightfield}),
    [](const auto& tested) { return std::string(tested.param.name); });

Terrain flat(double elevation_m = 0) {
  return terrain_of(GridSpec::centered(2, 0.5), [=](double, double) { return elevation_m; });
}

// One cell, [0, 1] x [0, 1], with the given corners.
struct CellHeights {
  double lower_left = 0;
  double lower_right = 0;
  double upper_left = 0;
  double upper_right = 0;
};
Terrain cell_of(const CellHeights& h) {
  Grid<double> nodes(GridSpec{1, 0, 0, 2, 2});
  nodes.at({0, 0}) = h.lower_left;
  nodes.at({0, 1}) = h.lower_right;
  nodes.at({1, 0}) = h.upper_left;
  nodes.at({1, 1}) = h.upper_right;
  return std::make_shared<const TriangulatedGrid>(std::move(nodes));
}

TEST_P(Engine, VerticalRangeIsTheHeight) {
  EXPECT_EQ(range(flat(), ray_from({0.3, -0.7, 500}, {0, 0, -1})), 500);
  EXPECT_EQ(range(flat(-7), ray_from({0.3, -0.7, 13}, {0, 0, -1})), 20);
}

TEST_P(Engine, SlantRangeOnFlatGround) {
  // 3-4-5: 4 m down while 3 m across; the hit at (1, 1).
  EXPECT_NEAR(range(flat(), ray_from({-2, 1, 4}, {0.6, 0, -0.8})), 5, 1e-12);
}

TEST_P(Engine, TiltedPlane) {
  const Terrain plane = terrain_of(GridSpec::centered(4, 0.25), [](double x, double) { return 0.5 * x; });
  // Straight down the plane's normal (-1, 0, 2)/sqrt(5) onto its point (1, 0.1, 0.5) from 10 m.
  const Eigen::Vector3d normal = Eigen::Vector3d(-1, 0, 2).normalized();
  EXPECT_NEAR(range(plane, ray_from(Eigen::Vector3d(1, 0.1, 0.5) + 10 * normal, -normal)), 10, 1e-12);
}

TEST_P(Engine, SurfaceIsTwoSided) { EXPECT_EQ(range(flat(), ray_from({0.3, 0.2, -3}, {0, 0, 1})), 3); }

TEST_P(Engine, BehindTheOriginIsAMiss) {
  EXPECT_TRUE(std::isnan(range(flat(), ray_from({0.3, 0.2, 3}, {0, 0, 1}))));
}

TEST_P(Engine, OutsideIsAMissAndTheBorderAHit) {
  EXPECT_EQ(range(flat(), ray_from({2, 0.3, 1}, {0, 0, -1})), 1);
  EXPECT_EQ(range(flat(), ray_from({2, 2, 1}, {0, 0, -1})), 1);
  EXPECT_TRUE(std::isnan(range(flat(), ray_from({2.0000001, 0.3, 1}, {0, 0, -1}))));
}

TEST_P(Engine, OriginOnTheSurfaceHasRangeZero) {
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 0, 1),
                                           Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.1, 0.7, -0.3)}) {
    EXPECT_EQ(range(flat(), ray_from({0.3, 0.2, 0}, direction)), 0);
    EXPECT_EQ(range(flat(), ray_from({0.5, 1, 0}, direction)), 0);      // a node
    EXPECT_EQ(range(flat(), ray_from({0.25, 1, 0}, direction)), 0);     // an edge
    EXPECT_EQ(range(flat(), ray_from({0.25, 0.25, 0}, direction)), 0);  // a diagonal
  }
}

TEST_P(Engine, DiagonalRunsFromLowerRightToUpperLeft) {
  const Terrain cell = cell_of({.lower_right = 1, .upper_left = 1});
  EXPECT_EQ(range(cell, ray_from({0.5, 0.5, 3}, {0, 0, -1})), 2);  // on the diagonal: height 1
  EXPECT_EQ(range(cell, ray_from({0.25, 0.25, 3}, {0, 0, -1})), 2.5);
  EXPECT_EQ(range(cell, ray_from({0.75, 0.75, 3}, {0, 0, -1})), 2.5);
}

TEST_P(Engine, RayInAPlaneMeetsItWhereItEnters) {
  EXPECT_EQ(range(flat(), ray_from({-5, 0.3, 0}, {1, 0, 0})), 3);
  EXPECT_EQ(range(flat(), ray_from({0.25, 7, 0}, {0, -1, 0})), 5);
  EXPECT_TRUE(std::isnan(range(flat(), ray_from({-5, 0.3, 0}, {-1, 0, 0}))));
  EXPECT_TRUE(std::isnan(range(flat(), ray_from({-5, 2.5, 0}, {1, 0, 0}))));
  // Along the row of nodes y = 0, and along the diagonals that meet the corner (2, -2).
  EXPECT_EQ(range(flat(), ray_from({-5, 0, 0}, {1, 0, 0})), 3);
  EXPECT_NEAR(range(flat(), ray_from({3, -3, 0}, {-1, 1, 0})), std::numbers::sqrt2, 1e-15);
}

// Touching a ridge from the side: the ray meets the surface in one edge only.
TEST_P(Engine, RayAlongARidgeHits) {
  const Terrain ridge = terrain_of(GridSpec::centered(2, 1), [](double x, double) { return -std::abs(x); });
  EXPECT_EQ(range(ridge, ray_from({-6, 0.5, 0}, {1, 0, 0})), 6);
  EXPECT_EQ(range(ridge, ray_from({0, -6, 0}, {0, 1, 0})), 4);
  EXPECT_TRUE(std::isnan(range(ridge, ray_from({-6, 0.5, 0x1p-40}, {1, 0, 0}))));
}

TEST_P(Engine, FirstOfSeveralHitsCounts) {
  const Terrain teeth = terrain_of(
      GridSpec::centered(4, 1), [](double x, double) { return std::fmod(std::abs(x), 2) == 1 ? 1.0 : 0.0; });
  EXPECT_NEAR(range(teeth, ray_from({-6, 0.3, 0.5}, {1, 0, 0})), 2.5, 1e-15);  // up the slope from x = -4
  EXPECT_NEAR(range(teeth, ray_from({6, 0.3, 0.5}, {-1, 0, 0})), 2.5, 1e-15);
  EXPECT_NEAR(range(teeth, ray_from({0, 0.3, 0.5}, {1, 0, 0})), 0.5, 1e-15);
}

TEST_P(Engine, HoleIsAMissAndItsBorderAHit) {
  const Terrain holed = cell_of({.upper_right = kNan});
  EXPECT_EQ(range(holed, ray_from({0.25, 0.25, 2}, {0, 0, -1})), 2);
  EXPECT_EQ(range(holed, ray_from({0.5, 0.5, 2}, {0, 0, -1})), 2);
  EXPECT_TRUE(std::isnan(range(holed, ray_from({0.75, 0.75, 2}, {0, 0, -1}))));
}

TEST_P(Engine, NothingButHolesIsAMiss) {
  EXPECT_TRUE(std::isnan(range(flat(kNan), ray_from({0.3, 0.2, 3}, {0, 0, -1}))));
}

TEST_P(Engine, RayThatIsNotFiniteMisses) {
  EXPECT_TRUE(std::isnan(range(flat(), {{{kNan, 0, 3}}, {{0, 0, -1}}})));
  EXPECT_TRUE(std::isnan(range(flat(), {{{0, 0, 3}}, {{kNan, kNan, kNan}}})));
  EXPECT_TRUE(std::isnan(range(flat(), {{{0, 0, std::numeric_limits<double>::infinity()}}, {{0, 0, -1}}})));
}

// Grazing: a hit under 1e-9 rad, where the plane's distance is too ill-conditioned for double.
TEST_P(Engine, GrazingRangeIsAccurate) {
  const double slope = 0x1p-30;
  const Terrain plane = terrain_of(GridSpec::centered(2, 1), [=](double x, double) { return slope * x; });
  // From x = -8 at height slope / 4, level: meets the plane where x = 1/4.
  EXPECT_NEAR(range(plane, ray_from({-8, 0.3, slope / 4}, {1, 0, 0})), 8.25, 1e-9);
}

TEST_P(Engine, FarOriginKeepsTheBound) {
  const Terrain plane =
      terrain_of(GridSpec::centered(8, 0.5), [](double x, double y) { return 0.3 * x - 0.2 * y; });
  const Eigen::Vector3d target(1.3, -0.7, 0.3 * 1.3 + 0.2 * 0.7);
  const Eigen::Vector3d origin(300, -4000, 10000);
  EXPECT_NEAR(range(plane, ray_at(origin, target)), (target - origin).norm(), 1e-9);
}

TEST_P(Engine, AnswersRayByRay) {
  const std::vector<Ray> rays = {ray_from({0, 0, 3}, {0, 0, -1}), ray_from({9, 0, 3}, {0, 0, -1}),
                                 ray_from({1, 1, 4}, {0, 0, -1})};
  const std::vector<double> ranges = ranges_of(*GetParam().make(flat()), rays);
  EXPECT_EQ(ranges[0], 3);
  EXPECT_TRUE(std::isnan(ranges[1]));
  EXPECT_EQ(ranges[2], 4);
  EXPECT_TRUE(ranges_of(*GetParam().make(flat()), {}).empty());
}

TEST_P(Engine, AnyNumberOfThreadsMayAsk) {
  const auto engine = GetParam().make(flat());
  std::vector<Ray> rays;
  for (int i = 0; i < 200; ++i) rays.push_back(ray_at({0, 0, 9}, {-2 + 0.02 * i, 0.5, 0}));
  const std::vector<double> alone = ranges_of(*engine, rays);
  std::vector<double> beside;
  std::thread other([&] { beside = ranges_of(*engine, rays); });
  const std::vector<double> here = ranges_of(*engine, rays);
  other.join();
  EXPECT_EQ(here, alone);
  EXPECT_EQ(beside, alone);
}

TEST(EngineProgress, RisesToOne) {
  const Terrain terrain = terrain_of(GridSpec::centered(100, 0.5), [](double x, double y) { return x * y; });
  std::vector<double> fractions;
  const ProgressCallback watch = [&](double fraction) { fractions.push_back(fraction); };
  const auto expect_rise = [&] {
    EXPECT_GE(fractions.size(), 3U);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_GE(fractions.front(), 0);
    EXPECT_EQ(fractions.back(), 1);
    fractions.clear();
  };
  (void)make_heightfield_engine(terrain, watch);
  expect_rise();
  (void)make_cgal_engine(terrain, watch);
  expect_rise();
}

// The doubles nearest to the exact ranges, as fractions of integers give them; 80 bits gave their neighbours.
TEST(WatertightRay, RangeIsTheSameOnEveryProcessor) {
  EXPECT_EQ(WatertightRay({{{-0.48, -0.52, 20}}, {{-0.16, -0.1, -1}}})
                .range_to({{{-7.262, -4.895, -0.62}, {9.548, 4.254, -0.88}, {-4.641, -2.001, 0.65}}}),
            0x1.44c5362a89841p+4);
  EXPECT_EQ(WatertightRay({{{0.74, -0.64, 20}}, {{0.05, -0.02, -1}}})
                .range_to({{{-6.074, -2.839, 0.77}, {8.445, -7.978, -0.98}, {5.272, 6.995, -0.11}}}),
            0x1.402dec671747fp+4);
}

TEST(Quad, ErrorOfAProductIsExact) {
  const Quad step = 0x1p-100;
  const Quad product = (1 + step) * (1 - step);
  EXPECT_EQ(static_cast<double>(product), 1);
  EXPECT_EQ(static_cast<double>(product_rest(1 + step, 1 - step, product)), -0x1p-200);
}

}  // namespace
}  // namespace landfall
