// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D409
// The plugin's side of raster_grid() and sample_raster() (lib/formats/gdal/gdal_loader.h).
#include "formats/gdal/raster_grid.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/core/parallel.h"
#include "base/text/number_text.h"
#include "formats/gdal/fill_values.h"
#include "formats/gdal/map_position.h"
#include "formats/gdal/map_projection.h"
#include "formats/gdal/open_raster.h"
#include "formats/gdal/plugin.h"
#include "formats/gdal/raster_statement.h"
#include "formats/gdal/site_relation.h"
#include "formats/gdal/window_reader.h"

namespace landfall {
namespace {

constexpr double kSquare = 1e-6;  ///< relative difference of the edges of a square pixel
constexpr std::int64_t kMaxSampled = std::int64_t{1} << 28U;

/// "gdalwarp -t_srs ... -tr 1 1 in.tif square.tif".
std::string warp_command(const DemBase& dem, const std::string& target, double posting) {
  return "gdalwarp " + (target.empty() ? "" : "-t_srs \"" + target + "\" ") + "-tr " + short_number(posting) +
         " " + short_number(posting) + " -r bilinear " + dem.path + " square.tif";
}

std::string plane_at(const LonLat& lon_lat) {
  constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
  return "+proj=ortho +lat_0=" + short_number(lon_lat.lat_rad * kDegreesPerRadian) +
         " +lon_0=" + short_number(std::remainder(lon_lat.lon_rad * kDegreesPerRadian, 360));
}

GeoTransform transform_of(const OpenRaster& raster, const RasterStatement& statement, const DemBase& dem) {
  const Georeference& georeference = statement.georeference;
  if (georeference.transform) return *georeference.transform;
  if (georeference.crs != nullptr)
    throw UsageError(dem.path + ": has a CRS but no geotransform; gdalwarp can make one from control points");
  return GeoTransform({0, 1, 0, static_cast<double>(raster.size.rows), 0, -1});
}

PixelPosition middle_of(const RasterSize& size) {
  return {static_cast<double>(size.cols - 1) / 2, static_cast<double>(size.rows - 1) / 2};
}

/// Metres per unit of the map. Refuses degrees and maps whose scale is not that of the ground.
double map_unit_m(const RasterStatement& statement, const GeoTransform& transform, const DemBase& dem,
                  const MapPoint& middle, std::vector<std::string>& assumed) {
  const OGRSpatialReference* const crs = statement.georeference.crs;
  const double edge = std::ranges::max(transform.edges());
  if (crs == nullptr) {
    if (dem.horizontal_scale_m) return *dem.horizontal_scale_m;
    if (statement.georeference.metres_per_unit > 0) return statement.georeference.metres_per_unit;
    assumed.emplace_back("has no CRS: its coordinates (pixels without a georeference) are taken as metres");
    return 1;
  }
  if (crs->IsGeographic() != 0) {
    const double radians = crs->GetAngularUnits();
    const double edge_m = edge * radians * crs->GetSemiMajor();
    throw UsageError(dem.path + ": its pixels are degrees, not squares on the ground: " +
                     warp_command(dem, plane_at({middle.x * radians, middle.y * radians}), edge_m));
  }
  const double unit_m = crs->GetLinearUnits();
  const std::optional<MapProjection> projection = MapProjection::of(*crs);
  if (!projection) return unit_m;
  const LonLat lon_lat = projection->lon_lat(middle);
  if (!std::isfinite(lon_lat.lon_rad) || !std::isfinite(lon_lat.lat_rad))
    throw FormatError(dem.path + ": its middle lies outside its map projection");
  if (map_distortion(*projection, OrthographicFrame(projection->body(), lon_lat), lon_lat, unit_m).matters())
    throw UsageError(dem.path +
                     ": its pixels are not squares on the ground, because the scale of its map is not 1: " +
                     warp_command(dem, plane_at(lon_lat), edge * unit_m));
  return unit_m;
}

void require_square(const GeoTransform& transform, const DemBase& dem) {
  const auto c = transform.coefficients();
  const bool is_upright = c[2] == 0 && c[4] == 0 && c[1] > 0 && c[5] < 0;
  const bool is_square = std::abs(c[1] + c[5]) <= kSquare * c[1];
  if (is_upright && is_square) return;
  throw UsageError(dem.path + ": its pixels are not " + (is_upright ? "square" : "north up") + ": " +
                   warp_command(dem, "", std::ranges::min(transform.edges())));
}

/// The pixel nearest to a centre.
PixelPosition origin_of(const OpenRaster& raster, const GeoTransform& transform, const DemBase& dem) {
  PixelPosition at =
      dem.center ? transform.pixel({(*dem.center)[0], (*dem.center)[1]}) : middle_of(raster.size);
  at = {std::floor(at.col + 0.5), std::floor(at.row + 0.5)};
  const bool inside = at.col >= 0 && at.row >= 0 && at.col < static_cast<double>(raster.size.cols) &&
                      at.row < static_cast<double>(raster.size.rows);
  if (!inside) {
    const MapPoint first = transform.map_point({-0.5, -0.5});
    const MapPoint last = transform.map_point(
        {static_cast<double>(raster.size.cols) - 0.5, static_cast<double>(raster.size.rows) - 0.5});
    throw UsageError(dem.path + ": the centre lies outside: x is in [" +
                     number_text(std::min(first.x, last.x)) + ", " + number_text(std::max(first.x, last.x)) +
                     "], y in [" + number_text(std::min(first.y, last.y)) + ", " +
                     number_text(std::max(first.y, last.y)) + "]");
  }
  return at;
}

/// The transformation from one CRS to another; none where they are the same.
std::unique_ptr<OGRCoordinateTransformation> transformation(const RasterStatement& from,
                                                            const DemBase& from_dem,
                                                            const RasterStatement& to,
                                                            const DemBase& to_dem) {
  const OGRSpatialReference* const a = from.georeference.crs;
  const OGRSpatialReference* const b = to.georeference.crs;
  if ((a == nullptr) != (b == nullptr))
    throw FormatError(
        (a == nullptr ? from_dem : to_dem).path + ": has no CRS, but " +
        (a == nullptr ? to_dem : from_dem).path +
        " has one; assign it with gdal_translate -a_srs, or take both as one frame with --same-frame");
  if (a == nullptr) return nullptr;
  OGRSpatialReference source = *a;
  OGRSpatialReference target = *b;
  source.StripVertical();
  target.StripVertical();
  source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  target.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (source.IsSame(&target) != 0) return nullptr;
  std::unique_ptr<OGRCoordinateTransformation> made(OGRCreateCoordinateTransformation(&source, &target));
  if (!made)
    throw FormatError(to_dem.path + ": its CRS cannot be transformed to that of " + from_dem.path +
                      "; reproject it with gdalwarp");
  return made;
}

void require_readable_whole(const OpenRaster& raster, const DemBase& dem) {
  if (raster.size.rows * raster.size.cols > kMaxSampled)
    throw FormatError(
        dem.path + ": has " + grouped(raster.size.cols) + " x " + grouped(raster.size.rows) +
        " pixels, more than 256 Mpx; cut out the place (gdal_translate -projwin ULX ULY LRX LRY)");
}

/// Another raster, sampled at points of its map.
class PointSamples {
 public:
  PointSamples(const OpenRaster& raster, const RasterStatement& statement, const DemBase& dem,
               GdalErrors& errors)
      : dem_(dem),
        elevation_(statement.elevation),
        transform_(transform_of(raster, statement, dem)),
        middle_(transform_.map_point(middle_of(raster.size))),
        is_integer_(GDALDataTypeIsInteger(raster.band->GetRasterDataType()) != 0) {
    require_readable_whole(raster, dem);
    if (const OGRSpatialReference* crs = statement.georeference.crs;
        crs != nullptr && crs->IsGeographic() != 0)
      turn_ = 2 * std::numbers::pi / crs->GetAngularUnits();
    samples_ = WindowReader(raster, statement, dem, errors).read({0, 0, raster.size});
  }

  /// The elevation, bilinear; longitudes may differ from those of the raster by whole turns.
  [[nodiscard]] double at(MapPoint point) {
    if (turn_ > 0) point.x = middle_.x + std::remainder(point.x - middle_.x, turn_);
    const PixelPosition pixel = transform_.pixel(point);
    if (inside(samples_.size, Interpolation::bilinear, pixel)) use(pixel);
    return dem_.vertical_scale.value_or(1) * interpolate(samples_, Interpolation::bilinear, pixel);
  }
  /// Throws FormatError for undeclared fill values where at() used the raster; returns a sentence of doubt.
  [[nodiscard]] std::optional<std::string> check_fills() const {
    if (!used_) return std::nullopt;
    return check_fill_values(samples_, *used_, elevation_, is_integer_, dem_);
  }
  /// A hash of its samples and georeference.
  [[nodiscard]] std::string id() const {
    const auto c = transform_.coefficients();
    return Hash().update(std::as_bytes(std::span(samples_.values))).update(std::as_bytes(std::span(c))).hex();
  }

 private:
  void use(const PixelPosition& p) {
    if (!used_) used_ = PixelBox{p, p};
    used_->low = {std::min(used_->low.col, p.col), std::min(used_->low.row, p.row)};
    used_->high = {std::max(used_->high.col, p.col), std::max(used_->high.row, p.row)};
  }

  const DemBase& dem_;
  Scaling elevation_;
  GeoTransform transform_;
  MapPoint middle_;
  bool is_integer_;
  double turn_ = 0;  ///< of longitude, units of the raster; 0: its coordinates are not longitudes
  DemSamples samples_;
  std::optional<PixelBox> used_;
};

}  // namespace

RasterGrid grid_of_raster(const DemBase& asked, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster raster = open_raster(asked, links, errors);
  require_readable_whole(raster, asked);
  const RasterStatement statement = raster_statement(raster, asked);
  const GeoTransform transform = transform_of(raster, statement, asked);
  if (!transform.invertible()) throw FormatError(asked.path + ": its geotransform gives cells without area");
  RasterGrid grid{.spec = {}, .origin = {}, .center = {}, .dem = asked, .crs_name = {}};
  const double unit_m =
      map_unit_m(statement, transform, asked, transform.map_point(middle_of(raster.size)), grid.assumed);
  require_square(transform, asked);
  grid.origin = origin_of(raster, transform, asked);
  grid.center = transform.map_point(grid.origin);
  const auto col = std::llround(grid.origin.col);
  const auto row = std::llround(grid.origin.row);
  grid.spec = {std::ranges::min(transform.edges()) * unit_m, row + 1 - raster.size.rows, -col,
               raster.size.rows, raster.size.cols};
  grid.dem.center.reset();
  grid.dem.center_pixel = std::array<double, 2>{grid.origin.col, grid.origin.row};
  grid.dem.interpolation = Interpolation::nearest;
  grid.dem.datum = Datum::none;
  if (statement.georeference.crs == nullptr) grid.dem.horizontal_scale_m = unit_m;
  if (statement.georeference.crs != nullptr && statement.georeference.crs->GetName() != nullptr)
    grid.crs_name = statement.georeference.crs->GetName();
  return grid;
}

SampledRaster sample_at_bins(const DemBase& truth, const RasterGrid& grid, RasterLinks links) {
  GdalErrors errors;
  const OpenRaster own = open_raster(grid.dem, links, errors);
  const RasterStatement own_statement = raster_statement(own, grid.dem);
  const GeoTransform own_transform = transform_of(own, own_statement, grid.dem);
  const OpenRaster raster = open_raster(truth, links, errors);
  const RasterStatement statement = raster_statement(raster, truth);
  const auto to_truth = grid.same_frame ? nullptr : transformation(own_statement, grid.dem, statement, truth);
  PointSamples samples(raster, statement, truth, errors);
  SampledRaster result{.z = Grid<double>(grid.spec), .source_id = samples.id()};
  result.is_reprojected = to_truth != nullptr;
  if (const OGRSpatialReference* const crs = statement.georeference.crs)
    result.crs_wkt = placed_on(kLocalSiteCrsWkt, *crs, {}, 0, vertical_datum_of(*crs));
  result.assumed = statement.assumed;
  if (to_truth)
    if (std::string shift = datum_shift(*own_statement.georeference.crs, *statement.georeference.crs);
        !shift.empty())
      result.assumed.push_back(std::move(shift));
  std::vector<double> x(static_cast<std::size_t>(grid.spec.cols));
  std::vector<double> y(x.size());
  std::vector<int> done(x.size(), TRUE);
  for (std::int64_t row = 0; row < grid.spec.rows; ++row) {
    for (std::size_t col = 0; col < x.size(); ++col) {
      const MapPoint p =
          own_transform.map_point({static_cast<double>(col), static_cast<double>(grid.spec.rows - 1 - row)});
      x[col] = p.x;
      y[col] = p.y;
    }
    if (to_truth) to_truth->Transform(static_cast<int>(x.size()), x.data(), y.data(), nullptr, done.data());
    for (std::size_t col = 0; col < x.size(); ++col)
      result.z.at({row, static_cast<std::int64_t>(col)}) =
          done[col] != FALSE ? samples.at({x[col], y[col]}) : std::nan("");
  }
  if (auto doubt = samples.check_fills()) result.assumed.push_back(std::move(*doubt));
  return result;
}

}  // namespace landfall
