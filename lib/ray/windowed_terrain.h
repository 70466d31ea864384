// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>

#include "raster/grid_spec.h"
#include "ray/engine.h"
#include "terrain/relief/large_terrain.h"
#include "terrain/relief/triangulated_grid.h"
#include "terrain/surface.h"

namespace landfall {

/// Bounds of points, metres, inclusive; empty where low > high.
struct GroundBox {
  double low_x = std::numeric_limits<double>::infinity();
  double high_x = -std::numeric_limits<double>::infinity();
  double low_y = std::numeric_limits<double>::infinity();
  double high_y = -std::numeric_limits<double>::infinity();

  void add(double x_m, double y_m);
  void add(const GroundBox& box);
  [[nodiscard]] bool empty() const { return low_x > high_x || low_y > high_y; }
  [[nodiscard]] bool contains(const GroundBox& box) const;
};

/// Makes an engine for a window; empty if no rays are traced.
using EngineMaker =
    std::function<std::unique_ptr<const RayEngine>(std::shared_ptr<const TriangulatedGrid> surface)>;

/// A large terrain as a surface and as an engine, through one window that grows as points and rays need it.
///
/// Answers do not depend on the window. The positions of the nodes do not (CellOrigin), and an answer is
/// given only when the window certainly holds everything that decides it. A ray can meet the surface only
/// between the elevations lowest_m and highest_m of the terrain: the window must hold the points where the
/// ray enters and leaves this range, or hits. A window is a rectangle, so it also holds what the ray crosses
/// in between. A window counts as ending one cell inside its border, except at the terrain's border. Answers
/// equal those of make_heightfield_engine() for the whole terrain with CellOrigin::of_windows(), bit for bit.
class WindowedTerrain final : public TerrainSurface, public RayEngine {
 public:
  /// Throws UsageError unless CellOrigin::has_windows(terrain.spec).
  WindowedTerrain(LargeTerrain terrain, EngineMaker make_engine);

  /// Extends the window to hold these points, as far as they lie on the terrain.
  void require(const GroundBox& box) const;

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override;
  /// 0 as long as there is no window.
  [[nodiscard]] std::size_t efficient_rays() const override;
  [[nodiscard]] double elevation(double x_m, double y_m) const override;
  [[nodiscard]] double highest_m() const override { return terrain_.highest_m; }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point) const override;
  void cosines(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> directions,
               std::span<double> out) const override;

  /// The nodes that are in memory; empty at first.
  [[nodiscard]] GridSpec window() const;

 private:
  struct Window;

  [[nodiscard]] std::shared_ptr<const Window> current() const;
  [[nodiscard]] bool off_terrain(double x_m, double y_m) const;
  [[nodiscard]] std::shared_ptr<const Window> holding(const GroundBox& needed) const;
  [[nodiscard]] GroundBox needed_by(const Ray& ray, double range_m) const;
  [[nodiscard]] GridSpec nodes_around(GroundBox box) const;
  [[nodiscard]] std::shared_ptr<const Window> load(const GridSpec& spec) const;

  LargeTerrain terrain_;
  EngineMaker make_engine_;
  CellOrigin origin_;
  mutable std::mutex growing_;
  mutable std::shared_mutex reading_;
  mutable std::shared_ptr<const Window> window_;
};

}  // namespace landfall
