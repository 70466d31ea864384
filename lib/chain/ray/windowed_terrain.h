// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <span>

#include "base/raster/grid_spec.h"
#include "chain/ray/engine.h"
#include "chain/terrain/relief/large_terrain.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// A rectangle of frame D, metres, borders included; empty where low > high.
struct TerrainBox {
  double low_x = std::numeric_limits<double>::infinity();
  double high_x = -std::numeric_limits<double>::infinity();
  double low_y = std::numeric_limits<double>::infinity();
  double high_y = -std::numeric_limits<double>::infinity();

  /// Extends the box to hold the point or the other box.
  void add(double x_m, double y_m);
  void add(const TerrainBox& box);
  [[nodiscard]] bool empty() const { return low_x > high_x || low_y > high_y; }
  [[nodiscard]] bool contains(const TerrainBox& box) const;
};

/// Makes an engine for the surface of a window. An empty function if no rays are traced.
using EngineMaker =
    std::function<std::unique_ptr<const RayEngine>(std::shared_ptr<const TriangulatedGrid> surface)>;

/// A large terrain as a surface and as an engine. One window of it is in memory, and grows as points and rays
/// need it.
///
/// Answers do not depend on the window: they equal those of make_heightfield_engine() for the whole terrain
/// with CellOrigin::of_windows(), bit for bit. The node positions are rounded in the same way for any window
/// (CellOrigin), and an answer is given only when the window certainly holds everything that decides it. A
/// ray can meet the surface only between the terrain's elevations lowest_m and highest_m: the window must
/// hold the point where the ray enters this range, and the point where it hits or leaves the range. As a
/// rectangle, it then also holds what the ray crosses in between. One cell inside the window's border does
/// not count as held, except at the terrain's border.
///
/// Any number of threads may use it.
class WindowedTerrain final : public TerrainSurface, public RayEngine {
 public:
  /// Throws UsageError unless CellOrigin::has_windows(terrain.spec).
  WindowedTerrain(LargeTerrain terrain, EngineMaker make_engine);

  /// Extends the window to hold these points, as far as they lie on the terrain.
  void require(const TerrainBox& box) const;

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override;
  [[nodiscard]] double elevation(double x_m, double y_m) const override;
  [[nodiscard]] double highest_m() const override { return terrain_.highest_m; }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point) const override;
  void cosines(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> directions,
               std::span<double> out) const override;

  /// The nodes that are in memory; none at first.
  [[nodiscard]] GridSpec window() const;

 private:
  struct Window;

  [[nodiscard]] std::shared_ptr<const Window> current() const;
  [[nodiscard]] bool off_terrain(double x_m, double y_m) const;
  [[nodiscard]] std::shared_ptr<const Window> holding(const TerrainBox& needed) const;
  [[nodiscard]] TerrainBox needed_by(const Ray& ray, double range_m) const;
  [[nodiscard]] GridSpec nodes_around(TerrainBox box) const;
  [[nodiscard]] std::shared_ptr<const Window> load(const GridSpec& spec) const;

  LargeTerrain terrain_;
  EngineMaker make_engine_;
  CellOrigin origin_;
  mutable std::mutex growing_;         ///< one thread at a time loads a window
  mutable std::shared_mutex reading_;  ///< protects window_
  mutable std::shared_ptr<const Window> window_;
};

}  // namespace landfall
