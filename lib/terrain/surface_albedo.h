// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

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
