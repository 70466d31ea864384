// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D19, D130
#include "formats/gdal/site_frame.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/map_position.h"
#include "formats/gdal/map_projection.h"
#include "formats/gdal/site_crs.h"
#include "formats/gdal/site_relation.h"

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

/// A raster whose columns follow longitude and whose rows follow latitude, in units of `radians`.
RasterCover cover_of(const GeoTransform& transform, const RasterSize& size, double radians) {
  RasterCover cover;
  const Eigen::Matrix2d pixels = transform.pixels_per_unit() / radians;
  if (pixels(0, 1) != 0 || pixels(1, 0) != 0) return cover;
  const double period = 2 * std::numbers::pi * std::abs(pixels(0, 0));
  constexpr double kWholePixel_px = 0.01;
  const bool is_whole = std::abs(period - std::round(period)) < kWholePixel_px;
  const bool is_covered = static_cast<double>(size.cols) >= std::round(period);
  if (!is_whole || !is_covered) return cover;
  cover.period = std::llround(period);
  if (cover.period % 2 != 0) return cover;
  const auto row_of = [&](double lat_rad) { return transform.pixel({0, lat_rad / radians}).row; };
  const double pole = std::numbers::pi / 2;
  const double first = row_of(pixels(1, 1) < 0 ? pole : -pole);
  const double last = row_of(pixels(1, 1) < 0 ? -pole : pole);
  const auto is_at = [](double row, double edge) { return std::abs(row - edge) < kWholePixel_px; };
  const auto rows = static_cast<double>(size.rows);
  for (const double edge : {-0.5, 0.0})
    if (is_at(first, edge)) cover.first_pole = edge;
  for (const double edge : {rows - 0.5, rows - 1})
    if (is_at(last, edge)) cover.last_pole = edge;
  return cover;
}

struct LonLatRaster {
  const GeoTransform& transform;
  RasterSize size;
  double radians;  ///< per unit of its coordinates
  Ellipsoid body;
};

/// `geographic` is the CRS of the raster's longitudes and latitudes.
SiteFrame lon_lat_frame(const LonLatRaster& raster, const OGRSpatialReference& geographic, const DemBase& dem,
                        const PixelPosition& center) {
  const MapPoint point = raster.transform.map_point(center);
  const LonLat lon_lat{point.x * raster.radians, point.y * raster.radians};
  constexpr double kPole = std::numbers::pi / 2;
  if (!(std::abs(lon_lat.lat_rad) <= kPole * (1 + 1e-12)))
    throw FormatError(dem.path + ": the site centre's latitude " +
                      number_text(lon_lat.lat_rad * 180 / std::numbers::pi) + " lies beyond a pole");
  const OrthographicFrame frame(raster.body, lon_lat);
  const double posting_m =
      std::ranges::max(raster.transform.edges()) * raster.radians * raster.body.semi_major_m;
  return {SiteMapping(raster.transform, center, frame, raster.radians),
          orthographic_wkt(geographic, lon_lat_of(geographic, lon_lat)),
          posting_m,
          cover_of(raster.transform, raster.size, raster.radians),
          {}};
}

SiteFrame geographic_frame(const Georeference& georeference, const GeoTransform& transform,
                           const DemBase& dem, const PixelPosition& center) {
  const OGRSpatialReference& crs = *georeference.crs;
  if (crs.IsDerivedGeographic())
    throw FormatError(dem.path + ": has a rotated-pole CRS; gdalwarp can bring it to a plain one");
  return lon_lat_frame({transform, georeference.size, crs.GetAngularUnits(), body_of(crs)}, crs, dem, center);
}

/// A projected map in an orthographic frame.
class ProjectedSite {
 public:
  ProjectedSite(const Georeference& georeference, const GeoTransform& transform, const DemBase& dem,
                const PixelPosition& center, MapProjection projection)
      : georeference_(georeference),
        transform_(transform),
        dem_(dem),
        center_(center),
        projection_(std::move(projection)),
        lon_lat_(projection_.lon_lat(transform.map_point(center))),
        geographic_(georeference.crs->CloneGeogCS()) {}

  /// None where the map's scale is that of the ground.
  [[nodiscard]] std::optional<SiteFrame> frame() const {
    if (!std::isfinite(lon_lat_.lon_rad) || !std::isfinite(lon_lat_.lat_rad))
      throw FormatError(dem_.path + ": the site centre lies outside its map projection; give another center");
    const OrthographicFrame frame(projection_.body(), lon_lat_);
    const MapDistortion distortion =
        map_distortion(projection_, frame, lon_lat_, georeference_.crs->GetLinearUnits());
    if (!distortion.matters()) return std::nullopt;
    const std::optional<LinearMap> linear = linear_map(projection_, lon_lat_);
    return linear && linear->y_per_lat ? equidistant(*linear) : general(frame, linear);
  }

 private:
  /// An equidistant cylindrical map: a raster of longitudes and latitudes in other units.
  [[nodiscard]] SiteFrame equidistant(const LinearMap& map) const {
    const MapPoint at = transform_.map_point(center_);
    const auto c = transform_.coefficients();
    const double x = 1 / map.x_per_lon;
    const double y = 1 / *map.y_per_lat;
    const GeoTransform radians({lon_lat_.lon_rad + (c[0] - at.x) * x, c[1] * x, c[2] * x,
                                lon_lat_.lat_rad + (c[3] - at.y) * y, c[4] * y, c[5] * y});
    return lon_lat_frame({radians, georeference_.size, 1, projection_.body()}, *geographic_, dem_, center_);
  }

  /// Any other map, point by point.
  [[nodiscard]] SiteFrame general(const OrthographicFrame& frame,
                                  const std::optional<LinearMap>& linear) const {
    const auto pixel_of = [projection = projection_, transform = transform_, lon_lat = lon_lat_,
                           around = linear ? 2 * std::numbers::pi * std::abs(linear->x_per_lon) : 0.0,
                           middle = transform_.map_point(center_)](const LonLat& difference) {
      MapPoint point =
          projection.map_point({lon_lat.lon_rad + difference.lon_rad, lon_lat.lat_rad + difference.lat_rad});
      if (around > 0) point.x = middle.x + std::remainder(point.x - middle.x, around);  // across the seam
      return transform.pixel(point);
    };
    const MapPoint center = lon_lat_of(*geographic_, lon_lat_);
    SiteFrame site{SiteMapping(center_, frame, pixel_of), orthographic_wkt(*geographic_, center), 0, {}, {}};
    site.posting_m = site.mapping.posting_m();
    if (!(std::isfinite(site.posting_m) && site.posting_m > 0))
      throw FormatError(
          dem_.path + ": its map projection is singular at the site; gdalwarp -t_srs \"+proj=ortho +lat_0=" +
          short_number(center.y) + " +lon_0=" + short_number(center.x) + "\" can map it");
    return site;
  }

  const Georeference& georeference_;
  const GeoTransform& transform_;
  const DemBase& dem_;
  PixelPosition center_;
  MapProjection projection_;
  LonLat lon_lat_;
  std::unique_ptr<OGRSpatialReference> geographic_;
};

/// A projected map; its own axes where its scale is that of the ground.
SiteFrame projected_frame(const Georeference& georeference, const GeoTransform& transform, const DemBase& dem,
                          const PixelPosition& center) {
  const OGRSpatialReference& crs = *georeference.crs;
  const double metres_per_unit = crs.GetLinearUnits();
  if (!(std::isfinite(metres_per_unit) && metres_per_unit > 0))
    throw FormatError(dem.path + ": its CRS has no linear unit");
  std::vector<std::string> assumed;
  const std::optional<MapProjection> projection = MapProjection::of(crs);
  if (projection) {
    if (auto site = ProjectedSite(georeference, transform, dem, center, *projection).frame()) {
      return std::move(*site);
    }
  } else if (crs.IsProjected() != 0) {
    assumed.emplace_back("its map projection is not known: a scale of 1 is assumed at the site");
  }
  return {SiteMapping(transform, center, metres_per_unit),
          shifted_wkt(crs, projection, transform.map_point(center)),
          std::ranges::min(transform.edges()) * metres_per_unit,
          {},
          std::move(assumed),
          metres_per_unit};
}

double unreferenced_scale(const Georeference& georeference, const DemBase& dem) {
  if (!dem.horizontal_scale_m && georeference.metres_per_unit > 0) return georeference.metres_per_unit;
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

/// A raster without a georeference counts pixels, whose position is none on a map: its centre is 0, 0.
SiteFrame local_frame(const Georeference& georeference, const GeoTransform& transform, const DemBase& dem,
                      const PixelPosition& center) {
  const double scale_m = unreferenced_scale(georeference, dem);
  const MapPoint at = georeference.transform ? transform.map_point(center) : MapPoint{};
  const MapPlace place{.center = {at.x, at.y, 0}, .metres_per_unit = scale_m, .vertical = {}, .map_wkt = {}};
  return {SiteMapping(transform, center, scale_m),
          with_place(kLocalSiteCrsWkt, place),
          std::ranges::min(transform.edges()) * scale_m,
          {},
          {}};
}

SiteFrame map_frame(const Georeference& georeference, const GeoTransform& transform, const DemBase& dem,
                    const PixelPosition& center) {
  const OGRSpatialReference& crs = *georeference.crs;
  if (dem.horizontal_scale_m) {
    const char* name = crs.GetName();
    throw UsageError(dem.path + ": horizontal_scale_m is for rasters without a CRS, this one has \"" +
                     (name != nullptr ? name : "unnamed") + "\"");
  }
  if (crs.IsGeocentric()) throw FormatError(dem.path + ": its CRS is geocentric, not a map");
  return crs.IsGeographic() ? geographic_frame(georeference, transform, dem, center)
                            : projected_frame(georeference, transform, dem, center);
}

}  // namespace

SiteFrame site_frame(const Georeference& georeference, const DemBase& dem) {
  const GeoTransform transform = usable_transform(georeference, dem);
  const PixelPosition center = center_pixel(georeference, transform, dem);
  if (georeference.crs == nullptr) return local_frame(georeference, transform, dem, center);
  SiteFrame frame = map_frame(georeference, transform, dem, center);
  frame.crs_wkt = placed_on(frame.crs_wkt, *georeference.crs, transform.map_point(center),
                            frame.metres_per_unit, vertical_datum_of(*georeference.crs));
  return frame;
}

}  // namespace landfall
