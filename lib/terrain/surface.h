// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <limits>

namespace landfall {

/// The true surface of a terrain, frame D, metres: what rays hit and what a DEM is compared with. Immutable:
/// any number of threads may ask.
class TerrainSurface {
 public:
  virtual ~TerrainSurface() = default;

  /// H(x, y): the highest elevation of the surface on the vertical through (x, y); NaN where it has none.
  [[nodiscard]] virtual double elevation(double x_m, double y_m) const = 0;

  /// No elevation is greater, metres; infinite where that is not known.
  [[nodiscard]] virtual double highest_m() const { return std::numeric_limits<double>::infinity(); }

  /// A unit normal, of either sense, of the triangle that `point`, a point of the surface, lies on: on an
  /// edge or node of one of those that share it. NaN where there is no triangle.
  [[nodiscard]] virtual Eigen::Vector3d normal(const Eigen::Vector3d& point) const = 0;

  /// Whether everything below elevation() is underground, where no lidar can be.
  [[nodiscard]] virtual bool is_ground_below() const { return true; }

 protected:
  TerrainSurface() = default;
  TerrainSurface(const TerrainSurface&) = default;
  TerrainSurface(TerrainSurface&&) = default;
  TerrainSurface& operator=(const TerrainSurface&) = default;
  TerrainSurface& operator=(TerrainSurface&&) = default;
};

}  // namespace landfall
