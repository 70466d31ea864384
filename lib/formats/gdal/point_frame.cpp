// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D405
// The plugin's side of point_frame() (lib/formats/gdal/gdal_loader.h).
#include "formats/gdal/point_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "formats/gdal/map_position.h"
#include "formats/gdal/map_projection.h"
#include "formats/gdal/plugin.h"
#include "formats/gdal/point_crs.h"
#include "formats/gdal/site_crs.h"

namespace landfall {
namespace {

/// Longitudes and latitudes in an orthographic frame.
void use_lon_lat(PointFrame& frame, const OGRSpatialReference& crs, const PointFrameRequest& request) {
  if (crs.IsDerivedGeographic() != 0)
    throw FormatError(request.name + ": has a rotated-pole CRS, which is not read");
  const double radians = crs.GetAngularUnits();
  constexpr double kPole = std::numbers::pi / 2 * (1 + 1e-12);
  for (const double latitude : {request.low.y, request.high.y, frame.center.y})
    if (!(std::abs(latitude * radians) <= kPole))
      throw FormatError(request.name + ": a latitude of " + number_text(latitude) +
                        " lies beyond a pole: are its coordinates those of its CRS? --crs gives another; "
                        "body-fixed x, y, z take --crs \"+proj=geocent +a=" +
                        number_text(crs.GetSemiMajor()) + " +b=" + number_text(crs.GetSemiMinor()) + "\"");
  const LonLat lon_lat{frame.center.x * radians, frame.center.y * radians};
  const OrthographicFrame plane(body_of(crs), lon_lat);
  const double turn = 2 * std::numbers::pi / radians;
  frame.site = [plane, center = frame.center, radians, turn](const MapPoint& p) {
    return plane.point({std::remainder(p.x - center.x, turn) * radians, (p.y - center.y) * radians});
  };
  if (request.high.x - request.low.x > turn / 2)
    frame.lon_lat = [radians](const MapPoint& p) { return LonLat{p.x * radians, p.y * radians}; };
  frame.metres_per_unit = 0;
  frame.crs_wkt = orthographic_wkt(crs, lon_lat_of(crs, lon_lat));
}

/// True for a map whose meridians are cut at a seam and whose parallels are straight (cylindrical and
/// pseudocylindrical ones), and for points that may lie on both sides of the seam: it may be near at any
/// distance from the middle, because parallels become shorter towards the poles.
bool may_cross_seam(const MapProjection& projection, const LonLat& lon_lat, const PointFrameRequest& request,
                    double metres_per_unit) {
  constexpr double kStep = 0.02;
  constexpr double kMinWidth = 0.01;
  const double radius = projection.body().semi_major_m / metres_per_unit;
  if (!(request.high.x - request.low.x > kMinWidth * radius)) return false;
  const double y = projection.map_point(lon_lat).y;
  return std::ranges::any_of(std::array{-kStep, kStep}, [&](double step) {
    const double there = projection.map_point({lon_lat.lon_rad + step, lon_lat.lat_rad}).y;
    return std::abs(there - y) <= 1e-9 * radius;
  });
}

/// A map whose scale at the site is not that of the ground, or whose seam lies among the points, point by
/// point in an orthographic frame.
bool use_plane(PointFrame& frame, const OGRSpatialReference& crs, const MapProjection& projection,
               const PointFrameRequest& request) {
  const LonLat lon_lat = projection.lon_lat(frame.center);
  if (!std::isfinite(lon_lat.lon_rad) || !std::isfinite(lon_lat.lat_rad))
    throw FormatError(request.name +
                      ": the site centre lies outside its map projection: are its coordinates those of its "
                      "CRS? --crs gives another");
  const OrthographicFrame plane(projection.body(), lon_lat);
  if (may_cross_seam(projection, lon_lat, request, crs.GetLinearUnits())) {
    frame.lon_lat = [projection](const MapPoint& p) { return projection.lon_lat(p); };
    frame.one_thread = true;
  }
  if (!request.across_seam && !map_distortion(projection, plane, lon_lat, crs.GetLinearUnits()).matters())
    return false;
  const std::unique_ptr<OGRSpatialReference> geographic(crs.CloneGeogCS());
  frame.site = [plane, projection, lon_lat](const MapPoint& p) {
    const LonLat at = projection.lon_lat(p);
    return plane.point({at.lon_rad - lon_lat.lon_rad, at.lat_rad - lon_lat.lat_rad});
  };
  frame.one_thread = true;
  frame.metres_per_unit = 0;
  frame.crs_wkt = orthographic_wkt(*geographic, lon_lat_of(*geographic, lon_lat));
  return true;
}

void use_map(PointFrame& frame, const OGRSpatialReference& crs, const PointFrameRequest& request,
             const std::optional<MapProjection>& projection) {
  if (projection && use_plane(frame, crs, *projection, request)) return;
  if (!projection && crs.IsProjected() != 0)
    frame.assumed.emplace_back("its map projection is not known: a scale of 1 is assumed at the site");
  frame.crs_wkt = shifted_wkt(crs, projection, frame.center);
}

/// The unit that the file states for x and y is that of the CRS. International and US feet are taken for each
/// other: a header does not distinguish them.
void require_stated_unit(const PointFrameRequest& request, const OGRSpatialReference& crs) {
  if (!request.stated) return;
  const StatedMapUnit& stated = *request.stated;
  const bool is_geographic = crs.IsGeographic() != 0;
  const char* unit = nullptr;
  const double size = is_geographic ? crs.GetAngularUnits(&unit) : crs.GetLinearUnits(&unit);
  const auto is_that = [&](double metres) { return std::abs(metres - size) <= 1e-5 * size; };
  const bool fits =
      stated.is_angle
          ? is_geographic && (stated.text.empty() || std::abs(size - std::numbers::pi / 180) < 1e-9)
          : !is_geographic && is_that(stated.metres[0]) && is_that(stated.metres[1]);
  if (fits) return;
  throw FormatError(
      request.name + ": x and y are " +
      (stated.is_angle ? "longitudes and latitudes in degrees" : "in " + stated.text) +
      " by their names, but the CRS counts in " + (unit != nullptr ? unit : "another unit") +
      ": give --crs that of the coordinates" +
      (stated.is_angle ? ", such as EPSG:4326" : "; a PROJ text may have +units=km or another unit"));
}

void set_heights(PointFrame& frame, const ReadCrs& read, const PointFrameRequest& request,
                 double metres_per_unit) {
  if (request.vertical_scale) {
    frame.metres_per_height = *request.vertical_scale;
  } else if (read.metres_per_height) {
    frame.metres_per_height = *read.metres_per_height;
  } else if (std::abs(metres_per_unit - 1) > 1e-9 && read.crs.IsGeographic() == 0) {
    frame.assumed.emplace_back(
        "its map is not in metres, and the unit of its heights is not declared: metres are assumed "
        "(--vertical-scale)");
  }
}

PointFrame body_fixed_frame(const OGRSpatialReference& crs, const PointFrameRequest& request) {
  const double metres_per_unit = crs.GetLinearUnits();
  if (!(std::isfinite(metres_per_unit) && metres_per_unit > 0))
    throw FormatError(request.name + ": its CRS has no linear unit");
  if (request.vertical_scale)
    throw UsageError(
        request.name +
        ": --vertical-scale does not apply to body-fixed x, y, z: their CRS gives one unit for all");
  PointFrame frame;
  frame.body_fixed = BodyFixed{body_of(crs), metres_per_unit};
  return frame;
}

/// Longitudes, latitudes and heights on the body of a geocentric CRS.
ReadCrs geodetic_crs(const OGRSpatialReference& geocentric) {
  const std::unique_ptr<OGRSpatialReference> geographic(geocentric.CloneGeogCS());
  ReadCrs read{.crs = *geographic, .metres_per_height = 1};
  read.crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return read;
}

/// The middle of the points. That of longitudes across the seam is in (-180, 180] degrees where the file has
/// negative ones, else in [0, 360).
MapPoint default_center(const PointFrameRequest& request, const OGRSpatialReference& crs,
                        const std::optional<MapProjection>& projection, double unit_m) {
  if (!request.across_seam) return rounded_center(request.low, request.high, unit_m);
  const LonLat middle = request.across_seam->middle();
  if (projection) {
    const MapPoint exact = projection->map_point(middle);
    const MapPoint rounded = rounded_center(exact, exact, unit_m);
    return std::isfinite(projection->lon_lat(rounded).lon_rad) ? rounded : exact;
  }
  const double radians = crs.GetAngularUnits();
  const double turn = 2 * std::numbers::pi / radians;
  MapPoint at{middle.lon_rad / radians, middle.lat_rad / radians};
  constexpr double kRounding = 1e-9;
  const double end = request.low.x < 0 ? turn / 2 * (1 + kRounding) : turn * (1 - kRounding);
  if (at.x > end) at.x -= turn;
  return rounded_center(at, at, unit_m);
}

}  // namespace

PointFrame point_frame_in_map(const PointFrameRequest& request) {
  ReadCrs read = read_point_crs(request.crs, request.name);
  const std::string crs_name = read.crs.GetName() != nullptr ? read.crs.GetName() : "unnamed";
  if (read.crs.IsGeocentric() != 0) {
    if (!request.is_geodetic) return body_fixed_frame(read.crs, request);
    read = geodetic_crs(read.crs);
  }
  const OGRSpatialReference& crs = read.crs;
  const bool is_geographic = crs.IsGeographic() != 0;
  const double unit_m = is_geographic ? crs.GetAngularUnits() * crs.GetSemiMajor() : crs.GetLinearUnits();
  if (!(std::isfinite(unit_m) && unit_m > 0))
    throw FormatError(request.name + ": its CRS has no linear unit");
  require_stated_unit(request, crs);
  PointFrame frame;
  const auto projection = is_geographic ? std::nullopt : MapProjection::of(crs);
  frame.center = request.center.value_or(default_center(request, crs, projection, unit_m));
  frame.metres_per_unit = unit_m;
  frame.crs_name = crs_name;
  if (is_geographic)
    use_lon_lat(frame, crs, request);
  else
    use_map(frame, crs, request, projection);
  set_heights(frame, read, request, unit_m);
  frame.crs_wkt = placed_on(frame.crs_wkt, crs, frame.center, frame.metres_per_unit, read.vertical);
  if (!read.replaced.empty())
    frame.assumed.push_back("its CRS is " + read.replaced + ", but --crs gives " + frame.crs_name +
                            ", which is used");
  return frame;
}

}  // namespace landfall
