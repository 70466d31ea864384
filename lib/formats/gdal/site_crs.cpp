// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/site_crs.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "chain/terrain/relief/dem_raster.h"

namespace landfall {
namespace {

/// True where `site` has its origin at `center` of `map`, both axes parallel and in metres.
bool is_shift_of(const MapProjection& site, const MapProjection& map, const MapPoint& center,
                 double metres_per_unit) {
  constexpr double kStep = 100;
  constexpr double kTolerance_m = 1e-3;  // the accuracy of inverse projections
  const double step_m = kStep * metres_per_unit;
  for (const auto& [steps_x, steps_y] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1)}) {
    const MapPoint at = site.map_point(map.lon_lat({center.x + steps_x * kStep, center.y + steps_y * kStep}));
    if (!(std::hypot(at.x - steps_x * step_m, at.y - steps_y * step_m) < kTolerance_m)) return false;
  }
  return true;
}

}  // namespace

std::string to_wkt(const OGRSpatialReference& crs, const char* format) {
  char* text = nullptr;
  const char* const options[] = {format, "MULTILINE=NO", nullptr};
  const OGRErr status = crs.exportToWkt(&text, options);
  const std::string wkt = text != nullptr ? text : "";
  CPLFree(text);
  return status == OGRERR_NONE ? wkt : "";
}

std::string shifted_wkt(const OGRSpatialReference& crs, const std::optional<MapProjection>& projection,
                        const MapPoint& center) {
  if (!projection) return kLocalSiteCrsWkt;
  const double metres_per_unit = crs.GetLinearUnits();
  OGRSpatialReference site = crs;
  site.StripVertical();
  site.SetLinearUnitsAndUpdateParameters(SRS_UL_METER, 1.0);
  const double easting_m = site.GetProjParm(SRS_PP_FALSE_EASTING) - center.x * metres_per_unit;
  const double northing_m = site.GetProjParm(SRS_PP_FALSE_NORTHING) - center.y * metres_per_unit;
  site.SetProjParm(SRS_PP_FALSE_EASTING, easting_m);
  site.SetProjParm(SRS_PP_FALSE_NORTHING, northing_m);
  site.SetProjCS("landfall site frame");
  const std::string wkt = to_wkt(site);
  OGRSpatialReference read_back;
  if (wkt.empty() || read_back.importFromWkt(wkt.c_str()) != OGRERR_NONE) return kLocalSiteCrsWkt;
  const std::optional<MapProjection> shifted = MapProjection::of(read_back);
  const bool is_shifted = shifted && is_shift_of(*shifted, *projection, center, metres_per_unit);
  return is_shifted ? wkt : kLocalSiteCrsWkt;
}

MapPoint lon_lat_of(const OGRSpatialReference& geographic, const LonLat& lon_lat) {
  const double radians = geographic.GetAngularUnits();
  return {std::remainder(lon_lat.lon_rad, 2 * std::numbers::pi) / radians, lon_lat.lat_rad / radians};
}

std::string orthographic_wkt(const OGRSpatialReference& geographic, const MapPoint& center) {
  OGRSpatialReference site;
  site.SetProjCS("landfall site frame");
  if (site.CopyGeogCSFrom(&geographic) != OGRERR_NONE) return kLocalSiteCrsWkt;
  site.SetOrthographic(center.y, center.x, 0, 0);
  const std::string wkt = to_wkt(site);
  return wkt.empty() ? kLocalSiteCrsWkt : wkt;
}

}  // namespace landfall
