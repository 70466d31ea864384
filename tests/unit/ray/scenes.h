// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "ray/engine.h"
#include "terrain/triangulated_grid.h"

namespace landfall {

using Terrain = std::shared_ptr<const TriangulatedGrid>;

/// A terrain whose node heights are height(x, y).
template <class Height>
Terrain terrain_of(const GridSpec& spec, Height height) {
  Grid<double> nodes(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col)
      nodes.at({row, col}) = height(spec.x(col), spec.y(row));
  return std::make_shared<const TriangulatedGrid>(std::move(nodes));
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

/// The seed of this run's random tests: LANDFALL_TEST_SEED, or a fixed one.
inline std::uint64_t test_seed() {
  const char* given = std::getenv("LANDFALL_TEST_SEED");
  return given == nullptr ? 20261121U : std::stoull(given);
}

}  // namespace landfall
