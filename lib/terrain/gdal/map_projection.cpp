// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/map_projection.h"

#include <ogr_spatialref.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// x and y transformed; NaN where it fails.
MapPoint transformed(OGRCoordinateTransformation& transformation, double x, double y) {
  int done = 0;
  if (transformation.TransformWithErrorCodes(1, &x, &y, nullptr, nullptr, &done) == FALSE || done != 0 ||
      !std::isfinite(x) || !std::isfinite(y))
    return {kNan, kNan};
  return {x, y};
}

}  // namespace

Ellipsoid body_of(const OGRSpatialReference& crs) {
  const double inverse_flattening = crs.GetInvFlattening();
  return {crs.GetSemiMajor(), inverse_flattening > 0 ? 1 / inverse_flattening : 0};
}

std::optional<MapProjection> MapProjection::of(const OGRSpatialReference& crs) {
  if (crs.IsProjected() == 0) return std::nullopt;
  OGRSpatialReference map = crs;
  map.StripVertical();
  map.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRSpatialReference> geographic(map.CloneGeogCS());
  if (!geographic) return std::nullopt;
  geographic->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  Transformation forward(OGRCreateCoordinateTransformation(geographic.get(), &map));
  Transformation inverse(forward ? forward->GetInverse() : nullptr);
  if (!inverse) return std::nullopt;
  return MapProjection(std::move(forward), std::move(inverse), geographic->GetAngularUnits(), body_of(map));
}

MapPoint MapProjection::map_point(const LonLat& ground) const {
  return transformed(*forward_, ground.lon_rad / radians_, ground.lat_rad / radians_);
}

LonLat MapProjection::ground(const MapPoint& point) const {
  const MapPoint degrees = transformed(*inverse_, point.x, point.y);
  return {degrees.x * radians_, degrees.y * radians_};
}

bool MapDistortion::matters() const {
  constexpr double kTolerance = 1e-3;
  return !(std::abs(x_scale - 1) <= kTolerance && std::abs(y_scale - 1) <= kTolerance &&
           std::abs(axes_angle_rad - std::numbers::pi / 2) <= kTolerance);
}

MapDistortion map_distortion(const MapProjection& projection, const OrthographicFrame& frame,
                             const LonLat& center, double metres_per_unit) {
  constexpr double kStep_m = 50;
  const auto map_at = [&](double x_m, double y_m) {
    const LonLat difference = frame.difference({x_m, y_m});
    const MapPoint point =
        projection.map_point({center.lon_rad + difference.lon_rad, center.lat_rad + difference.lat_rad});
    return Eigen::Vector2d(point.x, point.y);
  };
  Eigen::Matrix2d map_per_ground;
  map_per_ground.col(0) = map_at(kStep_m, 0) - map_at(-kStep_m, 0);
  map_per_ground.col(1) = map_at(0, kStep_m) - map_at(0, -kStep_m);
  map_per_ground *= metres_per_unit / (2 * kStep_m);
  const Eigen::Matrix2d ground_per_map = map_per_ground.inverse();
  const Eigen::Vector2d x = ground_per_map.col(0);
  const Eigen::Vector2d y = ground_per_map.col(1);
  const double angle = std::atan2(std::abs(x.x() * y.y() - x.y() * y.x()), x.dot(y));
  return {1 / x.norm(), 1 / y.norm(), angle};
}

std::optional<LinearMap> linear_map(const MapProjection& projection, const LonLat& center) {
  const MapPoint here = projection.map_point(center);
  // Away from the seam of the map: eastwards or westwards, towards the equator.
  constexpr double kStep = 0.02;
  const double north = center.lat_rad > 0 ? -kStep : kStep;
  const auto at = [&](double lon, double lat) {
    return projection.map_point({center.lon_rad + lon, center.lat_rad + lat});
  };
  for (const double east : {kStep, -kStep}) {
    const double x_per_lon = (at(east, 0).x - here.x) / east;
    const double y_per_lat = (at(0, north).y - here.y) / north;
    const double tolerance = 1e-9 * std::abs(x_per_lon);  // some millimetres
    const auto near = [&](double a, double b) { return std::abs(a - b) <= tolerance; };
    const MapPoint half = at(east / 2, north / 2);
    const bool x_is_linear = near(half.x, here.x + x_per_lon * east / 2) && near(at(0, north).x, here.x) &&
                             near(at(east, 0).y, here.y);
    if (!x_is_linear) continue;
    if (near(half.y, here.y + y_per_lat * north / 2)) return LinearMap{x_per_lon, y_per_lat};
    return LinearMap{x_per_lon, std::nullopt};
  }
  return std::nullopt;
}

}  // namespace landfall
