// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/site_frame.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/error.h"
#include "base/number_text.h"

namespace landfall {
namespace {

/// Columns count from the left edge, rows from the bottom edge.
GeoTransform upright_pixels(const RasterSize& size) {
  return GeoTransform({0, 1, 0, static_cast<double>(size.rows), 0, -1});
}

GeoTransform usable_transform(const Georeference& georeference, const DemBase& dem) {
  if (!georeference.transform) {
    if (georeference.crs != nullptr)
      throw FormatError(dem.path +
                        ": has a CRS but no geotransform; gdalwarp can make one from control points");
    return upright_pixels(georeference.size);
  }
  if (!georeference.transform->invertible())
    throw FormatError(dem.path + ": its geotransform gives cells without area");
  return *georeference.transform;
}

/// The site centre; longitudes may differ from the raster's by whole turns.
PixelPosition center_pixel(const Georeference& georeference, const GeoTransform& transform,
                           const DemBase& dem) {
  if (dem.center && dem.center_pixel) throw UsageError(dem.path + ": give center or center_pixel, not both");
  const RasterSize& size = georeference.size;
  if (dem.center_pixel) return {(*dem.center_pixel)[0], (*dem.center_pixel)[1]};
  if (!dem.center) return {static_cast<double>(size.cols - 1) / 2, static_cast<double>(size.rows - 1) / 2};
  const MapPoint point{(*dem.center)[0], (*dem.center)[1]};
  const PixelPosition pixel = transform.pixel(point);
  if (georeference.crs == nullptr || !georeference.crs->IsGeographic()) return pixel;
  const double turn = 2 * std::numbers::pi / georeference.crs->GetAngularUnits();
  for (const double turns : {0.0, 1.0, -1.0}) {
    const PixelPosition turned = transform.pixel({point.x + turns * turn, point.y});
    if (inside(size, Interpolation::nearest, turned)) return turned;
  }
  return pixel;
}

std::string to_wkt(const OGRSpatialReference& crs) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2018", "MULTILINE=NO", nullptr};
  const OGRErr status = crs.exportToWkt(&text, options);
  const std::string wkt = text != nullptr ? text : "";
  CPLFree(text);
  return status == OGRERR_NONE ? wkt : "";
}

/// True where `site` has its origin at `center` of `crs`, both axes parallel and in metres.
bool is_shift_of(OGRSpatialReference site, OGRSpatialReference crs, const MapPoint& center) {
  site.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> transformation(
      OGRCreateCoordinateTransformation(&crs, &site));
  if (!transformation) return false;
  constexpr double kStep = 100;
  constexpr double kTolerance_m = 1e-3;  // the accuracy of inverse projections
  double x[] = {center.x, center.x + kStep, center.x};
  double y[] = {center.y, center.y, center.y + kStep};
  if (!transformation->Transform(3, x, y)) return false;
  const double step_m = kStep * crs.GetLinearUnits();
  const double expected_x[] = {0, step_m, 0};
  const double expected_y[] = {0, 0, step_m};
  for (int i = 0; i < 3; ++i)
    if (!(std::hypot(x[i] - expected_x[i], y[i] - expected_y[i]) < kTolerance_m)) return false;
  return true;
}

/// The same projection in metres with its false origin moved to the site centre; the local CRS where the
/// projection has no false origin or PROJ refuses.
std::string shifted_wkt(const OGRSpatialReference& crs, const MapPoint& center) {
  if (!crs.IsProjected()) return kLocalSiteCrsWkt;
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
  OGRSpatialReference horizontal = crs;
  horizontal.StripVertical();
  return is_shift_of(read_back, horizontal, center) ? wkt : kLocalSiteCrsWkt;
}

std::string orthographic_wkt(const OGRSpatialReference& geographic, const MapPoint& center) {
  OGRSpatialReference site;
  site.SetProjCS("landfall site frame");
  if (site.CopyGeogCSFrom(&geographic) != OGRERR_NONE) return kLocalSiteCrsWkt;
  site.SetOrthographic(center.y, center.x, 0, 0);
  const std::string wkt = to_wkt(site);
  return wkt.empty() ? kLocalSiteCrsWkt : wkt;
}

SiteFrame geographic_frame(const Georeference& georeference, const GeoTransform& transform,
                           const DemBase& dem, const PixelPosition& center) {
  const OGRSpatialReference& crs = *georeference.crs;
  if (crs.IsDerivedGeographic())
    throw FormatError(dem.path + ": has a rotated-pole CRS; gdalwarp can bring it to a plain one");
  const double radians = crs.GetAngularUnits();
  const MapPoint point = transform.map_point(center);
  if (!(std::abs(point.y * radians) <= std::numbers::pi / 2))
    throw FormatError(dem.path + ": the site centre's latitude " + number_text(point.y) +
                      " lies beyond a pole");
  const double inverse_flattening = crs.GetInvFlattening();
  const Ellipsoid body{crs.GetSemiMajor(), inverse_flattening > 0 ? 1 / inverse_flattening : 0};
  const OrthographicFrame frame(body, {point.x * radians, point.y * radians});
  const double turn = 2 * std::numbers::pi / radians;
  const MapPoint wrapped{std::remainder(point.x, turn), point.y};
  const double posting_m = std::ranges::max(transform.edges()) * radians * body.semi_major_m;
  return {SiteMapping(transform, center, frame, radians), orthographic_wkt(crs, wrapped), posting_m};
}

double unreferenced_scale(const Georeference& georeference, const DemBase& dem) {
  if (!dem.horizontal_scale_m && georeference.in_metres) return 1;
  if (!dem.horizontal_scale_m)
    throw UsageError(
        dem.path +
            ": has no CRS; assign one with gdal_translate -a_srs, or give the metres per unit of its "
            "coordinates (per pixel without a georeference) as horizontal_scale_m",
        "horizontal_scale_m");
  if (!(std::isfinite(*dem.horizontal_scale_m) && *dem.horizontal_scale_m > 0))
    throw UsageError(dem.path + ": horizontal_scale_m is not finite and positive");
  return *dem.horizontal_scale_m;
}

}  // namespace

SiteFrame site_frame(const Georeference& georeference, const DemBase& dem) {
  const GeoTransform transform = usable_transform(georeference, dem);
  const PixelPosition center = center_pixel(georeference, transform, dem);
  const OGRSpatialReference* crs = georeference.crs;
  const double shorter_edge = std::ranges::min(transform.edges());
  if (crs == nullptr) {
    const double scale_m = unreferenced_scale(georeference, dem);
    return {SiteMapping(transform, center, scale_m), kLocalSiteCrsWkt, shorter_edge * scale_m};
  }
  if (dem.horizontal_scale_m) {
    const char* name = crs->GetName();
    throw UsageError(dem.path + ": horizontal_scale_m is for rasters without a CRS, this one has \"" +
                     (name != nullptr ? name : "unnamed") + "\"");
  }
  if (crs->IsGeographic()) return geographic_frame(georeference, transform, dem, center);
  if (crs->IsGeocentric()) throw FormatError(dem.path + ": its CRS is geocentric, not a map");
  const double metres_per_unit = crs->GetLinearUnits();
  if (!(std::isfinite(metres_per_unit) && metres_per_unit > 0))
    throw FormatError(dem.path + ": its CRS has no linear unit");
  return {SiteMapping(transform, center, metres_per_unit), shifted_wkt(*crs, transform.map_point(center)),
          shorter_edge * metres_per_unit};
}

}  // namespace landfall
