// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/raster/grid_spec.h"
#include "base/raster/region.h"

namespace landfall {

/// An area with holes. Inside by the even-odd rule over the edges of all rings; a border belongs to its area,
/// to 1e-9 m.
class Polygon {
 public:
  /// Vertices in order, in either direction; the last one is joined to the first.
  using Ring = std::vector<Horizontal>;

  explicit Polygon(std::vector<Ring> rings) : rings_(std::move(rings)) {}

  [[nodiscard]] bool contains(Horizontal place) const;
  [[nodiscard]] const std::vector<Ring>& rings() const { return rings_; }

 private:
  std::vector<Ring> rings_;
};

/// Throws UsageError, which begins with `what`, for a coordinate that is not finite or beyond 1e9 m, for a
/// ring without area, and for edges that cross; those that touch within 1e-9 m do not.
void require_simple(const Polygon& polygon, const std::string& what);

/// The bins whose centre lies in one of the polygons, as far as they lie in the DEM.
[[nodiscard]] BinMask clipped_polygons(const GridSpec& dem, const std::vector<Polygon>& polygons);

/// The same bins. Throws UsageError, which begins with `what`, if a polygon reaches beyond the outer edges of
/// the DEM's bins, or if no bin's centre lies in one.
[[nodiscard]] BinMask polygon_region(const GridSpec& dem, const std::vector<Polygon>& polygons,
                                     const std::string& what);

}  // namespace landfall
