// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D386
#include "formats/gdal/map_position.h"

#include <ogr_spatialref.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "chain/terrain/site_wkt.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/map_projection.h"
#include "formats/gdal/site_crs.h"

namespace landfall {
namespace {

/// The map of a site frame; none without a place that names a projected one.
std::optional<OGRSpatialReference> map_of(const std::string& site_wkt) {
  OGRSpatialReference map;
  if (map.importFromWkt(map_wkt_of(site_wkt).c_str()) != OGRERR_NONE || map.IsProjected() == 0)
    return std::nullopt;
  return map;
}

std::optional<double> rounded(double value, double steps) {
  if (!std::isfinite(value)) return std::nullopt;
  return std::round(value * steps) / steps;
}

constexpr double kPerMetre = 1e4;
constexpr double kPerDegree = 1e9;  // 0.1 mm on the Earth
constexpr double kDegrees = 180 / std::numbers::pi;

}  // namespace

std::string placed_on(const std::string& site_wkt, const OGRSpatialReference& map, const MapPoint& center,
                      double metres_per_unit, const std::string& vertical) {
  OGRSpatialReference flat = map;
  flat.StripVertical();
  return with_place(site_wkt, {.center = {center.x, center.y, 0},
                               .metres_per_unit = metres_per_unit,
                               .vertical = vertical,
                               .map_wkt = to_wkt(flat)});
}

std::vector<MapPosition> map_positions_of(const std::string& site_wkt, const std::vector<SitePoint>& points) {
  const GdalErrors errors;  // silences GDAL: a text from a file may be anything
  std::vector<MapPosition> positions(points.size());
  OGRSpatialReference site;
  if (site.importFromWkt(site_wkt.c_str()) != OGRERR_NONE) return positions;
  const std::optional<MapProjection> projection = MapProjection::of(site);
  if (!projection) return positions;
  const std::optional<OGRSpatialReference> map = map_of(site_wkt);
  const std::optional<MapProjection> to_map = map ? MapProjection::of(*map) : std::nullopt;
  const double metres_per_unit = map ? map->GetLinearUnits() : 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LonLat lon_lat = projection->lon_lat({points[i].x_m, points[i].y_m});
    MapPosition& position = positions[i];
    position.latitude_deg = rounded(lon_lat.lat_rad * kDegrees, kPerDegree);
    position.longitude_deg =
        rounded(std::remainder(lon_lat.lon_rad, 2 * std::numbers::pi) * kDegrees, kPerDegree);
    if (!to_map) continue;
    const MapPoint at = to_map->map_point(lon_lat);
    position.easting_m = rounded(at.x * metres_per_unit, kPerMetre);
    position.northing_m = rounded(at.y * metres_per_unit, kPerMetre);
  }
  return positions;
}

}  // namespace landfall
