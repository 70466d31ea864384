// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D445
#include "formats/gdal/map_frame.h"

#include <ogr_spatialref.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "chain/terrain/site_wkt.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/known_crs.h"
#include "formats/gdal/map_projection.h"
#include "formats/gdal/site_crs.h"

namespace landfall {
namespace {

using SiteToLonLat = std::function<LonLat(const SitePoint&)>;
using SiteToMap = std::function<MapPoint(const SitePoint&)>;

constexpr double kRadians = std::numbers::pi / 180;

/// LAS describes a CRS by WKT 1.
std::string exported_wkt(const OGRSpatialReference& crs) {
  const std::string wkt = to_wkt(crs, "FORMAT=WKT1_GDAL");
  return wkt.empty() ? to_wkt(crs) : wkt;
}

void describe(MapFrame& frame, const OGRSpatialReference& crs) {
  frame.crs_name = crs.GetName() != nullptr ? crs.GetName() : "unnamed";
  frame.crs_wkt = exported_wkt(crs);
  if (frame.is_geographic) {
    const char* unit = nullptr;
    const double radians = crs.GetAngularUnits(&unit);
    frame.unit = std::abs(radians - kRadians) < 1e-12 ? "degree" : unit;
    frame.metres_per_unit = radians * crs.GetSemiMajor();
    return;
  }
  frame.metres_per_unit = crs.GetLinearUnits();
  frame.unit = length_unit_name(frame.metres_per_unit);
}

/// Longitudes and latitudes under the points of an orthographic site; none for another site.
std::optional<SiteToLonLat> lon_lat_of_site(const OGRSpatialReference& site) {
  const char* const method = site.GetAttrValue("PROJECTION");
  if (method == nullptr || !EQUAL(method, SRS_PT_ORTHOGRAPHIC)) return std::nullopt;
  const LonLat center{site.GetNormProjParm(SRS_PP_CENTRAL_MERIDIAN) * kRadians,
                      site.GetNormProjParm(SRS_PP_LATITUDE_OF_ORIGIN) * kRadians};
  return [plane = OrthographicFrame(body_of(site), center), center](const SitePoint& point) {
    const LonLat difference = plane.difference(point);
    return LonLat{center.lon_rad + difference.lon_rad, center.lat_rad + difference.lat_rad};
  };
}

SiteToMap degrees_of(const SiteToLonLat& lon_lat, const OGRSpatialReference& geographic) {
  return [lon_lat, radians = geographic.GetAngularUnits()](const SitePoint& point) {
    const LonLat at = lon_lat(point);
    return MapPoint{at.lon_rad / radians, at.lat_rad / radians};
  };
}

/// The map that the place of a site names.
std::optional<MapFrame> in_named_map(const OGRSpatialReference& site, const MapPlace& place) {
  OGRSpatialReference map;
  if (place.map_wkt.empty() || map.importFromWkt(place.map_wkt.c_str()) != OGRERR_NONE) return std::nullopt;
  map.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  MapFrame frame;
  frame.is_geographic = map.IsGeographic() != 0;
  describe(frame, map);
  frame.center = {place.center[0], place.center[1]};
  if (std::isfinite(place.center[2])) frame.center_height = place.center[2];
  if (place.metres_per_unit > 0) return frame;
  const auto lon_lat = lon_lat_of_site(site);
  const std::optional<MapProjection> to = MapProjection::of(map);
  if (!lon_lat || (!frame.is_geographic && !to)) return std::nullopt;
  if (frame.is_geographic)
    frame.map_point = degrees_of(*lon_lat, map);
  else
    frame.map_point = [lon_lat = *lon_lat, to = *to](const SitePoint& point) {
      return to.map_point(lon_lat(point));
    };
  return frame;
}

/// Longitude and latitude on the site's own body.
std::optional<MapFrame> in_degrees(const OGRSpatialReference& site) {
  const auto lon_lat = lon_lat_of_site(site);
  const std::unique_ptr<OGRSpatialReference> geographic(site.CloneGeogCS());
  if (!lon_lat || !geographic) return std::nullopt;
  MapFrame frame;
  frame.is_geographic = true;
  describe(frame, *geographic);
  frame.map_point = degrees_of(*lon_lat, *geographic);
  frame.center = frame.map_point({0, 0});
  return frame;
}

/// The site frame as a map of its own: that of a file which names no map.
MapFrame in_site_map(const OGRSpatialReference& site) {
  MapFrame frame;
  describe(frame, site);
  return frame;
}

}  // namespace

std::optional<MapFrame> map_frame_of(const std::string& site_wkt) {
  const GdalErrors errors;  // silences GDAL: a text from a file may be anything
  require_crs_database("site frame");
  OGRSpatialReference site;
  if (site.importFromWkt(site_wkt.c_str()) != OGRERR_NONE) return std::nullopt;
  site.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (const std::optional<MapPlace> place = place_of(site_wkt))
    if (std::optional<MapFrame> frame = in_named_map(site, *place)) return frame;
  if (site.IsProjected() == 0) return std::nullopt;
  if (std::optional<MapFrame> frame = in_degrees(site)) return frame;
  return in_site_map(site);
}

}  // namespace landfall
