// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "chain/terrain/relief/site_mapping.h"

class OGRSpatialReference;

namespace landfall {

/// The ellipsoid of a CRS.
[[nodiscard]] Ellipsoid body_of(const OGRSpatialReference& crs);

/// The map projection of a CRS: its coordinates from longitude and latitude on its own body and back, by
/// PROJ.
class MapProjection {
 public:
  class Transformation;

  /// None for a CRS without a projection (a local one), and where PROJ does not know it.
  [[nodiscard]] static std::optional<MapProjection> of(const OGRSpatialReference& crs);
  /// The same through GDAL's transformation, which searches PROJ's database first.
  [[nodiscard]] static std::optional<MapProjection> by_gdal(const OGRSpatialReference& crs);

  /// NaN outside the projection's domain. Not from several threads.
  [[nodiscard]] MapPoint map_point(const LonLat& lon_lat) const;
  [[nodiscard]] LonLat lon_lat(const MapPoint& point) const;
  [[nodiscard]] const Ellipsoid& body() const { return body_; }

 private:
  MapProjection(std::shared_ptr<const Transformation> transformation, const Ellipsoid& body)
      : transformation_(std::move(transformation)), body_(body) {}

  std::shared_ptr<const Transformation> transformation_;
  Ellipsoid body_;
};

/// How a map departs from ground distances around a point.
struct MapDistortion {
  double x_scale = 1;  ///< map distance along the map's x axis by ground distance
  double y_scale = 1;
  double axes_angle_rad = 0;  ///< of the map's axes on the ground
  /// True where a scale departs from 1, or the angle from a right one, by more than 1e-3.
  [[nodiscard]] bool matters() const;
};

/// At the frame's centre, from the projection's own values some 50 m around it. `metres_per_unit` is the size
/// of a unit of the map.
[[nodiscard]] MapDistortion map_distortion(const MapProjection& projection, const OrthographicFrame& frame,
                                           const LonLat& center, double metres_per_unit);

/// Map units per radian of longitude and of latitude, for a projection whose x is linear in longitude and
/// whose y is linear in latitude (equidistant cylindrical), or whose x is (Mercator and other cylindrical
/// ones).
struct LinearMap {
  double x_per_lon = 0;
  std::optional<double> y_per_lat;
};
[[nodiscard]] std::optional<LinearMap> linear_map(const MapProjection& projection, const LonLat& center);

}  // namespace landfall
