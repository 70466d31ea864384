// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>

#include "chain/ray/elevation_pyramid.h"
#include "chain/ray/grid_ray.h"
#include "chain/ray/watertight.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// The data that rays on a heightfield need. The terrain must outlive it.
struct Heightfield {
  const TriangulatedGrid& terrain;
  ElevationPyramid pyramid;
  GridFrame frame;

  explicit Heightfield(const TriangulatedGrid& surface, const ProgressCallback& progress = {});
  [[nodiscard]] const GridSpec& spec() const { return terrain.nodes().spec(); }
};

/// The descent of one ray through the pyramid, nearer block first, for any origin and any direction. A block
/// or cell is skipped only where the ray certainly misses it: each bound of a slab is within 4 units of 2^-53
/// of the exact bound, and widening by 2^-49 covers both (Ize, "Robust BVH ray traversal", JCGT 2013).
class PyramidTraversal {
 public:
  /// The ray must be finite.
  PyramidTraversal(const Heightfield& field, const Ray& ray);

  /// Distance to the first hit, metres; NaN for a miss.
  [[nodiscard]] double first_hit();

 private:
  /// The distances between which the ray is inside one or more slabs.
  struct Interval {
    double enter = 0;
    double leave = std::numeric_limits<double>::infinity();
    [[nodiscard]] bool empty() const { return enter > leave * (1 + 0x1p-49); }
  };

  [[nodiscard]] Interval within(Eigen::Index axis, double low, double high, Interval interval) const;
  void visit_block(int level, BinIndex block);
  void visit_children(int level, BinIndex block);
  void visit_cells(BinIndex block);
  void visit_cell(BinIndex cell, Interval interval);
  [[nodiscard]] double range_to(std::size_t triangle, const CornerTriangle& corner_triangle);

  const Heightfield& field_;
  Ray ray_;
  GridRay grid_ray_;
  Eigen::Array3d inverse_direction_;
  std::optional<WatertightRay> watertight_;  ///< constructed when first needed
  double best_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace landfall
