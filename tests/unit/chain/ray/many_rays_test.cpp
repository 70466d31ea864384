// SPDX-License-Identifier: GPL-3.0-or-later
// Many random rays of every kind, on terrains of every kind: the lanes answer what PyramidTraversal answers,
// to the last bit, the heightfield engine what CGAL's exact predicates answer, and no ray leaks.
// An OpenCL device answers what the engine answers. LANDFALL_TEST_RAYS sets the number of rays (a tenth of
// them for CGAL), LANDFALL_TEST_SEED the seed, LANDFALL_DATA the folder of real rasters (shared_data.h).
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>

#include "chain/ray/cgal_engine.h"
#include "chain/ray/heightfield_engine.h"
#include "chain/ray/packet_walk.h"
#include "chain/terrain/relief/fractal.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "formats/gdal/gdal_loader.h"
#include "scenes.h"
#include "shared_data.h"

namespace landfall {
namespace {

constexpr double kManyRaysTolerance_m = 1e-6;
constexpr std::size_t kPulseRays = 324;

/// The paper's ten cones of 10 m; on the paper's own grid where many rays are asked for.
Terrain paper_cones(Random&) {
  return terrain_of(GridSpec::centered(50, test_rays() < 1000000 ? 0.25 : 0.05), [](double x, double y) {
    double z = 0;
    for (int i = 0; i < 10; ++i) {
      const double azimuth = 0.2 * std::numbers::pi * i;
      const double distance = std::hypot(x - 25 * std::cos(azimuth), y - 25 * std::sin(azimuth));
      z = std::max(z, 10 * (1 - distance / 3));
    }
    return z;
  });
}

Terrain fractal(Random& random) {
  Grid<double> nodes(GridSpec::centered(64, 0.25));
  add_fractal(nodes, {0.7, 0.5, 5}, {random(), 0});
  return std::make_shared<const TriangulatedGrid>(std::move(nodes));
}

Terrain raster(const std::filesystem::path& path, const GridSpec& spec) {
  DemBase dem;
  dem.path = path.string();
  TerrainModel model;
  model.bases = {dem};
  return std::make_shared<const TriangulatedGrid>(generate_terrain(model, spec, load_dem).nodes);
}

const std::filesystem::path kRasters = std::filesystem::path(LANDFALL_TESTDATA) / "rasters";

Terrain europa_relief(Random&) {
  return raster(kRasters / "relief_europa_10m.tif", GridSpec::centered(520, 10));
}
Terrain moon_relief(Random&) { return raster(kRasters / "relief_moon_1m.tif", GridSpec::centered(64, 0.5)); }

/// Null without the data.
Terrain real_raster(const char* name, const GridSpec& spec) {
  const std::filesystem::path path = shared_data() / "dem" / name;
  return exists(path) ? raster(path, spec) : nullptr;
}

Terrain gale(Random&) { return real_raster("mars_gale_hirise_1m.tif", GridSpec::centered(160, 0.5)); }
Terrain europa(Random&) { return real_raster("europa_e26_terminator_10m.tif", GridSpec::centered(2560, 10)); }

class ManyRays : public testing::TestWithParam<Scene> {
 protected:
  void SetUp() override {
    terrain_ = GetParam().make(random_);
    if (!terrain_)
      GTEST_SKIP() << "no real rasters: " << shared_data() / "dem"
                   << " (LANDFALL_DATA)";
    const ElevationPyramid pyramid(terrain_->nodes());
    low_ = pyramid.lowest();
    high_ = pyramid.highest();
    const GridSpec& spec = terrain_->nodes().spec();
    middle_ = {(spec.x(0) + spec.x(spec.cols - 1)) / 2, (spec.y(0) + spec.y(spec.rows - 1)) / 2,
               (low_ + high_) / 2};
    half_ = Eigen::Vector3d(spec.x(spec.cols - 1), spec.y(spec.rows - 1), high_ + 1e-3) - middle_;
  }

  [[nodiscard]] Eigen::Vector3d unit_cube() {
    const double x = uniform(random_, -1, 1);
    const double y = uniform(random_, -1, 1);
    return {x, y, uniform(random_, -1, 1)};
  }
  /// Within the terrain's box, stretched.
  [[nodiscard]] Eigen::Vector3d in_box(double stretch) {
    return middle_ + (stretch * half_.array() * unit_cube().array()).matrix();
  }
  [[nodiscard]] Eigen::Vector3d random_node() {
    const GridSpec& spec = terrain_->nodes().spec();
    const BinIndex node{static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(spec.rows)),
                        static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(spec.cols))};
    const double z = terrain_->nodes().at(node);
    return {spec.x(node.col), spec.y(node.row), std::isnan(z) ? middle_.z() : z};
  }

  /// Above, among the heights, below, beside, or exactly on a node.
  [[nodiscard]] Eigen::Vector3d random_origin() {
    Eigen::Vector3d origin = in_box(1);
    const double far = uniform(random_, 0, 4) * half_.norm();
    switch (random_() % 5) {
      case 0:
        origin.z() = high_ + far;
        return origin;
      case 1:
        return origin;
      case 2:
        origin.z() = low_ - far;
        return origin;
      case 3:
        return in_box(3);
      default:
        return random_node();
    }
  }
  [[nodiscard]] Eigen::Vector3d random_direction(const Eigen::Vector3d& origin) {
    if (random_() % 4 != 0) return (in_box(1) - origin).normalized();
    return unit_cube().normalized();
  }

  /// Every other group is a pulse: rays of one origin, nearly parallel.
  [[nodiscard]] std::vector<Ray> random_rays(std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
      const bool in_pulse = i / kPulseRays % 2 == 1 && i % kPulseRays != 0;
      if (in_pulse) {
        rays.push_back(ray_from(rays.back().origin.v, rays.back().direction.v + 1e-4 * unit_cube()));
      } else {
        const Eigen::Vector3d origin = random_origin();
        rays.push_back({{origin}, {random_direction(origin)}});
      }
    }
    return rays;
  }

  Random random_{test_seed()};
  Terrain terrain_;
  double low_ = 0;
  double high_ = 0;
  Eigen::Vector3d middle_;  ///< of the terrain's box
  Eigen::Vector3d half_;
};

class ManyRaysWithoutHoles : public ManyRays {};

const Scene kWithoutHoles[] = {{"paper_cones", paper_cones},
                               {"gale", gale},
                               {"europa", europa},
                               {"europa_relief", europa_relief},
                               {"moon_relief", moon_relief},
                               {"fractal", fractal},
                               {"single_cell", single_cell},
                               {"strip", strip},
                               {"cliffs", cliffs}};

const auto name_of = [](const auto& tested) { return std::string(tested.param.name); };

INSTANTIATE_TEST_SUITE_P(Scenes, ManyRays, testing::ValuesIn(kWithoutHoles), name_of);
INSTANTIATE_TEST_SUITE_P(Holes, ManyRays, testing::Values(Scene{"relief_with_holes", relief_with_holes}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, ManyRaysWithoutHoles, testing::ValuesIn(kWithoutHoles), name_of);

TEST_P(ManyRays, LanesAnswerAsDescent) {
  constexpr std::size_t kBatch = 100 * kPulseRays;
  const Heightfield field(*terrain_);
  std::size_t traced = 0;
  std::size_t decided = 0;
  std::size_t different = 0;
  for (; traced < test_rays(); traced += kBatch) {
    const std::vector<Ray> rays = random_rays(kBatch);
    std::vector<double> ranges(rays.size());
    walk_packets(field, rays, ranges);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (ranges[i] == kUndecided) continue;
      ++decided;
      if (!same_bits(ranges[i], PyramidTraversal(field, rays[i]).first_hit())) ++different;
    }
  }
  std::cout << traced << " rays, the lanes decide " << decided << ", different " << different << '\n';
  EXPECT_EQ(different, 0U);
  EXPECT_GT(decided, traced / 2);
}

TEST_P(ManyRays, AnswersAsCgal) {
  const std::vector<Ray> rays = random_rays(std::max<std::size_t>(test_rays() / 10, 1000));
  const std::vector<double> expected = ranges_of(*make_cgal_engine(terrain_), rays);
  const std::vector<double> ranges = ranges_of(*make_heightfield_engine(terrain_), rays);
  std::size_t hits = 0;
  std::size_t different = 0;
  double largest_m = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!std::isnan(expected[i])) ++hits;
    if (std::isnan(ranges[i]) != std::isnan(expected[i])) ++different;
    if (!std::isnan(expected[i] - ranges[i]))
      largest_m = std::max(largest_m, std::abs(ranges[i] - expected[i]));
  }
  std::cout << rays.size() << " rays, " << hits << " hits, hit or miss different " << different
            << ", largest difference of ranges " << largest_m << " m\n";
  EXPECT_EQ(different, 0U);
  EXPECT_LE(largest_m, kManyRaysTolerance_m);
  EXPECT_GT(hits, rays.size() / 10);
}

// A ray that starts above the terrain and would end below it, both inside its borders, cannot miss where
// there are no holes.
TEST_P(ManyRaysWithoutHoles, NoneLeaksThroughNodesEdgesOrDiagonals) {
  const double depth = high_ - low_ + 2;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < std::max<std::size_t>(test_rays() / 10, 1000); ++i) {
    const auto corners = terrain_->triangle(random_() % terrain_->triangle_count());
    const std::size_t corner = random_() % 3;
    const Eigen::Vector3d target = random_() % 2 == 0
                                       ? corners[corner]
                                       : Eigen::Vector3d((corners[corner] + corners[(corner + 1) % 3]) / 2);
    Eigen::Vector3d origin = random_() % 4 == 0 ? target : in_box(1);
    origin.z() = high_ + 1;
    const Eigen::Vector3d end = origin + depth / (origin.z() - target.z()) * (target - origin);
    if (((end - middle_).array().abs() < half_.array()).head<2>().all())
      rays.push_back(ray_at(origin, target));
  }
  const std::vector<double> ranges = ranges_of(*make_heightfield_engine(terrain_), rays);
  const auto leaks = std::ranges::count_if(ranges, [](double r) { return std::isnan(r); });
  std::cout << rays.size() << " aimed rays, " << leaks << " leaks\n";
  EXPECT_EQ(leaks, 0);
  EXPECT_GT(rays.size(), 10U);
}

}  // namespace
}  // namespace landfall
