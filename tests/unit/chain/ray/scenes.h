// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bins.h"
#include "chain/ray/cgal_engine.h"
#include "chain/ray/engine.h"
#include "chain/ray/heightfield_engine.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "constants.h"
#include "test_seed.h"

namespace landfall {

using Terrain = std::shared_ptr<const TriangulatedGrid>;

/// A terrain whose node heights are height(x, y).
template <class Height>
Terrain terrain_of(const GridSpec& spec, Height height) {
  return std::make_shared<const TriangulatedGrid>(grid_of(spec, height));
}

inline Ray ray_from(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  return {{origin}, {direction.normalized()}};
}

inline Ray ray_at(const Eigen::Vector3d& origin, const Eigen::Vector3d& target) {
  return ray_from(origin, target - origin);
}

inline std::vector<double> ranges_of(const RayEngine& engine, const std::vector<Ray>& rays) {
  std::vector<double> ranges(rays.size());
  engine.first_hits(rays, ranges);
  return ranges;
}

inline std::unique_ptr<RayEngine> make_heightfield(Terrain terrain) {
  return make_heightfield_engine(std::move(terrain));
}
inline std::unique_ptr<RayEngine> make_cgal(Terrain terrain) { return make_cgal_engine(std::move(terrain)); }

/// The number of rays in tests with many rays: LANDFALL_TEST_RAYS, or 10^5.
inline std::size_t test_rays() {
  const char* given = std::getenv("LANDFALL_TEST_RAYS");
  return given == nullptr ? 100000U : std::stoull(given);
}

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

// Sums of sines with random phases, rougher as they get shorter.
inline Terrain fractal_relief(Random& random) {
  std::array<double, 24> phases{};
  for (double& phase : phases) phase = uniform(random, 0, 6.3);
  return terrain_of(GridSpec::centered(4, 0.5), [=](double x, double y) {
    double z = 0;
    for (std::size_t k = 0; k < phases.size(); k += 2) {
      const double wave = std::pow(1.6, static_cast<double>(k) / 2);
      z += std::pow(wave, -0.6) * std::sin(wave * x + phases[k]) * std::sin(wave * y + phases[k + 1]);
    }
    return z;
  });
}

inline Terrain cliffs(Random& random) {
  return terrain_of(GridSpec::centered(4, 0.5),
                    [&](double, double) { return random() % 3 == 0 ? 5.0 : 0.0; });
}

inline Terrain relief_with_holes(Random& random) {
  return terrain_of(GridSpec::centered(4, 0.5),
                    [&](double, double) { return random() % 8 == 0 ? kNan : uniform(random, -0.3, 0.3); });
}

inline Terrain single_cell(Random& random) {
  return terrain_of(GridSpec{1, 0, 0, 2, 2}, [&](double, double) { return uniform(random, -1, 1); });
}

inline Terrain strip(Random& random) {
  return terrain_of(GridSpec{0.5, -1, -12, 2, 25}, [&](double, double) { return uniform(random, -1, 1); });
}

inline Terrain flat_terrain(Random&) {
  return terrain_of(GridSpec::centered(4, 0.5), [](double, double) { return 0.0; });
}

// Ten cones on a plane, as in the paper's first example, on a coarse grid that ends 0.25 m beyond them.
inline Terrain cones(Random&) {
  return terrain_of(GridSpec::centered(3.25, 0.25), [](double x, double y) {
    double z = 0;
    for (int i = 0; i < 10; ++i) {
      const double azimuth = 0.2 * std::numbers::pi * i;
      z = std::max(z, 2 - 4 * std::hypot(x - 2.5 * std::cos(azimuth), y - 2.5 * std::sin(azimuth)));
    }
    return z;
  });
}

struct Scene {
  const char* name;
  Terrain (*make)(Random&);
};

/// Tests that run on each scene: INSTANTIATE_TEST_SUITE_P(Scenes, X, every_scene(), scene_name).
inline auto every_scene() {
  return testing::Values(Scene{"fractal_relief", fractal_relief}, Scene{"cliffs", cliffs},
                         Scene{"relief_with_holes", relief_with_holes}, Scene{"single_cell", single_cell},
                         Scene{"strip", strip}, Scene{"flat_ground", flat_terrain}, Scene{"cones", cones});
}
inline std::string scene_name(const testing::TestParamInfo<Scene>& tested) { return tested.param.name; }

class SceneTest : public testing::TestWithParam<Scene> {
 protected:
  void SetUp() override { terrain_ = GetParam().make(random_); }

  [[nodiscard]] Eigen::Vector3d random_offset(double half_width_m) {
    const auto draw = [&] { return uniform(random_, -half_width_m, half_width_m); };
    return {draw(), draw(), draw()};
  }
  /// Within the terrain's borders, or `margin_m` outside; up to 1 m above or below 0.
  [[nodiscard]] Eigen::Vector3d random_target(double margin_m = 0) {
    const GridSpec& spec = terrain_->nodes().spec();
    return {uniform(random_, spec.x(0) - margin_m, spec.x(spec.cols - 1) + margin_m),
            uniform(random_, spec.y(0) - margin_m, spec.y(spec.rows - 1) + margin_m),
            uniform(random_, -1, 1)};
  }

  Random random_{test_seed()};
  Terrain terrain_;
};

/// Equal bits, or neither is a number.
inline bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace landfall
