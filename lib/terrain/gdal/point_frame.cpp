// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D405
// The plugin's side of point_frame() (lib/terrain/gdal/gdal_loader.h).
#include "terrain/gdal/point_frame.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "base/error.h"
#include "base/number_text.h"
#include "terrain/gdal/map_position.h"
#include "terrain/gdal/map_projection.h"
#include "terrain/gdal/plugin.h"
#include "terrain/gdal/point_crs.h"
#include "terrain/gdal/site_crs.h"

namespace landfall {
namespace {

/// Longitudes and latitudes in an orthographic frame.
void use_ground(PointFrame& frame, const OGRSpatialReference& crs, const PointFrameRequest& request) {
  if (crs.IsDerivedGeographic() != 0)
    throw FormatError(request.name + ": has a rotated-pole CRS, which is not read");
  const double radians = crs.GetAngularUnits();
  constexpr double kPole = std::numbers::pi / 2 * (1 + 1e-12);
  for (const double latitude : {request.low.y, request.high.y, frame.center.y})
    if (!(std::abs(latitude * radians) <= kPole))
      throw FormatError(request.name + ": a latitude of " + number_text(latitude) +
                        " lies beyond a pole: are its coordinates those of its CRS? --crs gives another");
  const LonLat ground{frame.center.x * radians, frame.center.y * radians};
  const OrthographicFrame plane(body_of(crs), ground);
  frame.site = [plane, center = frame.center, radians](const MapPoint& p) {
    return plane.point({(p.x - center.x) * radians, (p.y - center.y) * radians});
  };
  frame.metres_per_unit = 0;
  frame.crs_wkt = orthographic_wkt(crs, lon_lat_of(crs, ground));
}

/// A map whose scale at the site is not that of the ground, point by point in an orthographic frame.
bool use_distorted(PointFrame& frame, const OGRSpatialReference& crs, const MapProjection& projection,
                   const PointFrameRequest& request) {
  const LonLat ground = projection.ground(frame.center);
  if (!std::isfinite(ground.lon_rad) || !std::isfinite(ground.lat_rad))
    throw FormatError(request.name +
                      ": the site centre lies outside its map projection: are its coordinates those of its "
                      "CRS? --crs gives another");
  const OrthographicFrame plane(projection.body(), ground);
  if (!map_distortion(projection, plane, ground, crs.GetLinearUnits()).matters()) return false;
  const std::unique_ptr<OGRSpatialReference> geographic(crs.CloneGeogCS());
  frame.site = [plane, projection, ground](const MapPoint& p) {
    const LonLat at = projection.ground(p);
    return plane.point({at.lon_rad - ground.lon_rad, at.lat_rad - ground.lat_rad});
  };
  frame.one_thread = true;
  frame.metres_per_unit = 0;
  frame.crs_wkt = orthographic_wkt(*geographic, lon_lat_of(*geographic, ground));
  return true;
}

void use_map(PointFrame& frame, const OGRSpatialReference& crs, const PointFrameRequest& request) {
  const std::optional<MapProjection> projection = MapProjection::of(crs);
  if (projection && use_distorted(frame, crs, *projection, request)) return;
  if (!projection && crs.IsProjected() != 0)
    frame.assumed.emplace_back("its map projection is not known: a scale of 1 is assumed at the site");
  frame.crs_wkt = shifted_wkt(crs, projection, frame.center);
}

/// The unit that the file states for x and y is that of the CRS. International and US feet are taken for each
/// other: a header does not tell them apart.
void require_stated_unit(const PointFrameRequest& request, const OGRSpatialReference& crs) {
  if (!request.stated) return;
  const StatedMapUnit& stated = *request.stated;
  const bool is_geographic = crs.IsGeographic() != 0;
  const char* unit = nullptr;
  const double size = is_geographic ? crs.GetAngularUnits(&unit) : crs.GetLinearUnits(&unit);
  const auto is_that = [&](double metres) { return std::abs(metres - size) <= 1e-5 * size; };
  const bool fits = stated.is_angle
                        ? is_geographic && std::abs(size - std::numbers::pi / 180) < 1e-9
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

}  // namespace

PointFrame point_frame_in_map(const PointFrameRequest& request) {
  const ReadCrs read = read_point_crs(request.crs, request.name);
  const OGRSpatialReference& crs = read.crs;
  if (crs.IsGeocentric() != 0) throw FormatError(request.name + ": its CRS is geocentric, not a map");
  const bool is_geographic = crs.IsGeographic() != 0;
  const double unit_m = is_geographic ? crs.GetAngularUnits() * crs.GetSemiMajor() : crs.GetLinearUnits();
  if (!(std::isfinite(unit_m) && unit_m > 0))
    throw FormatError(request.name + ": its CRS has no linear unit");
  require_stated_unit(request, crs);
  PointFrame frame;
  frame.center = request.center.value_or(rounded_center(request.low, request.high, unit_m));
  frame.metres_per_unit = unit_m;
  frame.crs_name = crs.GetName() != nullptr ? crs.GetName() : "unnamed";
  if (is_geographic)
    use_ground(frame, crs, request);
  else
    use_map(frame, crs, request);
  set_heights(frame, read, request, unit_m);
  frame.crs_wkt = placed_on(frame.crs_wkt, crs, frame.center, frame.metres_per_unit, read.vertical);
  if (!read.replaced.empty())
    frame.assumed.push_back("its CRS is " + read.replaced + ", but --crs gives " + frame.crs_name +
                            ", which is used");
  return frame;
}

}  // namespace landfall
