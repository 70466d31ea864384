// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace landfall {

/// The true surface of a terrain, frame D, metres: rays hit it and DEMs are compared with it. Immutable: any
/// number of threads may use it.
class TerrainSurface {
 public:
  virtual ~TerrainSurface() = default;

  /// H(x, y): the highest elevation of the surface on the vertical through (x, y); NaN off the surface.
  [[nodiscard]] virtual double elevation(double x_m, double y_m) const = 0;

  /// An upper bound of all elevations, metres; infinite if unknown.
  [[nodiscard]] virtual double highest_m() const { return std::numeric_limits<double>::infinity(); }

  /// A unit normal, of either sense, of the triangle at `point`, a point of the surface; on an edge or node,
  /// of one of the triangles that share it. NaN without a triangle.
  [[nodiscard]] virtual Eigen::Vector3d normal(const Eigen::Vector3d& point) const = 0;

  /// |cosine| of the angle between normal() at each point and the unit vector there, many times as fast on a
  /// grid; the spans have one length.
  virtual void cosines(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3d> directions,
                       std::span<double> out) const {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = std::abs(normal(points[i]).dot(directions[i]));
  }

  /// Whether everything below elevation() is underground, where no lidar can be.
  [[nodiscard]] virtual bool is_terrain_below() const { return true; }

 protected:
  TerrainSurface() = default;
  TerrainSurface(const TerrainSurface&) = default;
  TerrainSurface(TerrainSurface&&) = default;
  TerrainSurface& operator=(const TerrainSurface&) = default;
  TerrainSurface& operator=(TerrainSurface&&) = default;
};

/// The albedo of a surface. From any thread.
class SurfaceAlbedo {
 public:
  virtual ~SurfaceAlbedo() = default;

  /// In [0, 1], at a position in D, metres; NaN off the terrain.
  [[nodiscard]] virtual double at(double x_m, double y_m) const = 0;

 protected:
  SurfaceAlbedo() = default;
  SurfaceAlbedo(const SurfaceAlbedo&) = default;
  SurfaceAlbedo(SurfaceAlbedo&&) = default;
  SurfaceAlbedo& operator=(const SurfaceAlbedo&) = default;
  SurfaceAlbedo& operator=(SurfaceAlbedo&&) = default;
};

}  // namespace landfall
