// SPDX-License-Identifier: GPL-3.0-or-later
// Property tests: the fast engines answer what brute force answers, and no ray leaks. LANDFALL_TEST_SEED sets
// the seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "brute_force.h"
#include "chain/ray/cgal_engine.h"
#include "chain/ray/heightfield_engine.h"
#include "scenes.h"

namespace landfall {
namespace {

constexpr double kTolerance_m = 1e-9;

struct EngineKind {
  const char* name;
  std::unique_ptr<RayEngine> (*make)(Terrain);
};
std::vector<EngineKind> fast_engines() { return {{"cgal", make_cgal}, {"heightfield", make_heightfield}}; }

std::vector<EngineKind> all_engines() {
  std::vector<EngineKind> engines = fast_engines();
  engines.push_back({"brute force", make_brute_force_engine<TriangulatedGrid>});
  return engines;
}

class Agreement : public SceneTest {
 protected:
  void expect_same_answers(const std::vector<Ray>& rays) const {
    const std::vector<double> expected = ranges_of(*make_brute_force_engine(terrain_), rays);
    const auto hits =
        std::count_if(expected.begin(), expected.end(), [](double r) { return !std::isnan(r); });
    EXPECT_GT(hits, static_cast<std::ptrdiff_t>(rays.size() / 50));  // the scene is worth asking about
    for (const EngineKind& kind : fast_engines()) {
      const std::vector<double> ranges = ranges_of(*kind.make(terrain_), rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool same = std::isnan(expected[i]) ? std::isnan(ranges[i])
                                                  : std::abs(ranges[i] - expected[i]) <= kTolerance_m;
        EXPECT_TRUE(same) << kind.name << ", ray " << i << ": " << ranges[i] << ", brute force "
                          << expected[i];
      }
    }
  }

  /// In the terrain's own extent, or a little outside.
  [[nodiscard]] Eigen::Vector3d random_target() {
    return SceneTest::random_target(terrain_->nodes().spec().resolution_m / 4);
  }
};

INSTANTIATE_TEST_SUITE_P(Scenes, Agreement, every_scene(), scene_name);

TEST_P(Agreement, RandomRaysInAllDirections) {
  std::vector<Ray> rays;
  for (int i = 0; i < 4000; ++i) rays.push_back(ray_at(random_offset(7), random_target()));
  expect_same_answers(rays);
}

TEST_P(Agreement, RaysFromAbove) {
  std::vector<Ray> rays;
  for (int i = 0; i < 4000; ++i)
    rays.push_back(ray_at(random_offset(20) + Eigen::Vector3d(0, 0, 500), random_target()));
  expect_same_answers(rays);
}

// Origins around, inside and below the terrain. LANDFALL_TEST_RAYS sets their number.
TEST_P(Agreement, HeightfieldAnswersAsCgalOnManyRays) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < test_rays(); ++i)
    rays.push_back(i % 2 == 0 ? ray_at(random_offset(7), random_target())
                              : ray_from(random_target(), random_offset(1)));
  const std::vector<double> expected = ranges_of(*make_cgal_engine(terrain_), rays);
  const std::vector<double> ranges = ranges_of(*make_heightfield_engine(terrain_), rays);
  double largest_m = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(std::isnan(ranges[i]), std::isnan(expected[i])) << "ray " << i << ": " << expected[i];
    if (!std::isnan(expected[i])) largest_m = std::max(largest_m, std::abs(ranges[i] - expected[i]));
  }
  std::cout << rays.size() << " rays, largest difference " << largest_m << " m\n";
  EXPECT_LE(largest_m, kTolerance_m);
}

// Vertical and level rays through nodes and edges: their coordinates are exact, so the borders of the surface
// and of holes must be judged alike to the last bit.
TEST_P(Agreement, AxisParallelRaysAtGridCoordinates) {
  const GridSpec& spec = terrain_->nodes().spec();
  const double half = spec.resolution_m / 2;
  std::vector<Ray> rays;
  for (double y = spec.y(0) - half; y <= spec.y(spec.rows - 1) + half; y += half)
    for (double x = spec.x(0) - half; x <= spec.x(spec.cols - 1) + half; x += half) {
      rays.push_back(ray_from({x, y, 9}, {0, 0, -1}));
      rays.push_back(ray_from({x, y, -9}, {0, 0, 1}));
      rays.push_back(ray_from({x, -40, y}, {0, 1, 0}));
      rays.push_back(ray_from({-40, x, y}, {1, 0, 0}));
      rays.push_back(ray_from({x, y, 0}, {-1, 0, 0}));
    }
  expect_same_answers(rays);
}

/// Points of the inner surface that triangles share: nodes, edge midpoints, diagonal midpoints.
std::vector<Eigen::Vector3d> shared_points(const TriangulatedGrid& terrain) {
  std::vector<Eigen::Vector3d> points;
  const GridSpec& spec = terrain.nodes().spec();
  for (std::size_t id = 0; id < terrain.triangle_count(); ++id) {
    const auto corners = terrain.triangle(id);
    points.insert(points.end(), corners.begin(), corners.end());
    for (std::size_t i = 0; i < 3; ++i) points.emplace_back((corners[i] + corners[(i + 1) % 3]) / 2);
  }
  const auto on_border = [&](const Eigen::Vector3d& p) {
    return p.x() == spec.x(0) || p.x() == spec.x(spec.cols - 1) || p.y() == spec.y(0) ||
           p.y() == spec.y(spec.rows - 1);
  };
  std::erase_if(points, on_border);
  return points;
}

class Leaks : public Agreement {};

INSTANTIATE_TEST_SUITE_P(Scenes, Leaks,
                         testing::Values(Scene{"fractal_relief", fractal_relief}, Scene{"cliffs", cliffs},
                                         Scene{"flat_ground", flat_terrain}),
                         scene_name);

// From so far above, no flank of these scenes turns its back: the ray meets the very point it is aimed at.
TEST_P(Leaks, SteepRaysMeetNodesEdgesAndDiagonals) {
  std::vector<Ray> rays;
  std::vector<double> distances;
  for (const Eigen::Vector3d& point : shared_points(*terrain_))
    for (const Eigen::Vector3d& origin :
         {Eigen::Vector3d(0, 0, 500), Eigen::Vector3d(point.x(), point.y(), 20)}) {
      rays.push_back(ray_at(origin, point));
      distances.push_back((point - origin).norm());
    }
  for (const EngineKind& kind : all_engines()) {
    const std::vector<double> ranges = ranges_of(*kind.make(terrain_), rays);
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_NEAR(ranges[i], distances[i], kTolerance_m) << kind.name << ", ray " << i;
  }
}

// A ray that starts above the terrain and would end below it, both inside its borders, cannot miss; it may
// pass a ridge it was aimed at by a rounding and hit later.
TEST_P(Leaks, ObliqueRaysAtNodesEdgesAndDiagonalsHit) {
  constexpr double kTop_m = 6;
  constexpr double kBottom_m = -6;
  const GridSpec& spec = terrain_->nodes().spec();
  std::vector<Ray> rays;
  for (const Eigen::Vector3d& point : shared_points(*terrain_))
    for (int i = 0; i < 10; ++i) {
      Eigen::Vector3d origin = random_offset(4);
      origin.z() = kTop_m;
      const Eigen::Vector3d end = origin + (kTop_m - kBottom_m) / (kTop_m - point.z()) * (point - origin);
      if (std::abs(end.x()) < spec.x(spec.cols - 1) && std::abs(end.y()) < spec.y(spec.rows - 1))
        rays.push_back(ray_at(origin, point));
    }
  ASSERT_GT(rays.size(), 500U);
  for (const EngineKind& kind : all_engines()) {
    const std::vector<double> ranges = ranges_of(*kind.make(terrain_), rays);
    EXPECT_EQ(std::count_if(ranges.begin(), ranges.end(), [](double r) { return std::isnan(r); }), 0)
        << kind.name;
  }
}

}  // namespace
}  // namespace landfall
