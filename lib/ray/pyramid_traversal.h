// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "ray/elevation_pyramid.h"
#include "ray/grid_ray.h"
#include "ray/watertight.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {

/// What rays on a heightfield need. The terrain must outlive it.
struct Heightfield {
  const TriangulatedGrid& terrain;
  ElevationPyramid pyramid;
  GridFrame frame;

  explicit Heightfield(const TriangulatedGrid& surface, const ProgressCallback& progress = {});
  [[nodiscard]] const GridSpec& spec() const { return terrain.nodes().spec(); }
};

/// One ray's way down the pyramid, nearer block first, for any origin and any direction. A block or cell is
/// left out only where the ray certainly passes it by: each bound of a slab is within 4 units of 2^-53 of the
/// exact one, the widening by 2^-49 makes up for both sides (Ize, "Robust BVH ray traversal", JCGT 2013).
class PyramidTraversal {
 public:
  /// The ray must be finite.
  PyramidTraversal(const Heightfield& field, const Ray& ray);

  /// Distance to the first hit, metres; NaN where there is none.
  [[nodiscard]] double first_hit();

 private:
  /// Distances between which the ray is inside a slab, or several.
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
  std::optional<WatertightRay> watertight_;  ///< made when first needed
  double best_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace landfall
