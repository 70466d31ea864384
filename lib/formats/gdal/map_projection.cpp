// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D372
#include "formats/gdal/map_projection.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>
#include <proj.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kNoPlace = std::numeric_limits<double>::quiet_NaN();

/// Parameters of a projection itself. With any other one (a datum shift, a prime meridian, other axes) GDAL
/// must transform, which first searches PROJ's database for some 14 ms.
constexpr std::array kOwnParameters = {"proj", "lat_0", "lat_1", "lat_2", "lat_ts",  "lon_0",
                                       "lonc", "alpha", "gamma", "k",     "k_0",     "x_0",
                                       "y_0",  "zone",  "south", "units", "to_meter"};
/// The body's and those without a meaning here; body_of() says the body.
constexpr std::array kLeftOut = {"ellps", "datum", "R", "a", "b", "rf", "no_defs", "type"};

template <std::size_t N>
bool is_among(const std::array<const char*, N>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// The projection alone as PROJ's parameters; none where it takes more than that.
std::optional<std::string> projection_text(const OGRSpatialReference& map) {
  char* exported = nullptr;
  const OGRErr status = map.exportToProj4(&exported);
  std::istringstream words(status == OGRERR_NONE && exported != nullptr ? exported : "");
  CPLFree(exported);
  std::string text;
  for (std::string word; words >> word;) {
    const std::string name = word.substr(1, word.find('=') - 1);
    if (is_among(kLeftOut, name)) continue;
    if (!is_among(kOwnParameters, name)) return std::nullopt;
    text += word + " ";
  }
  if (text.empty()) return std::nullopt;
  const double inverse_flattening = map.GetInvFlattening();
  text += "+a=" + number_text(map.GetSemiMajor());
  return text + (inverse_flattening > 0 ? " +rf=" + number_text(inverse_flattening) : " +f=0");
}

}  // namespace

/// Longitude and latitude in radians to the map and back.
class MapProjection::Transformation {
 public:
  Transformation() = default;
  Transformation(const Transformation&) = delete;
  Transformation& operator=(const Transformation&) = delete;
  virtual ~Transformation() = default;
  [[nodiscard]] virtual MapPoint forward(const LonLat& lon_lat) const = 0;
  [[nodiscard]] virtual LonLat inverse(const MapPoint& point) const = 0;
};

namespace {

/// By PROJ itself.
class ByProj final : public MapProjection::Transformation {
 public:
  explicit ByProj(const std::string& text) : context_(proj_context_create()) {
    // Its level of messages leaves some.
    proj_log_func(context_.get(), nullptr, [](void* /*data*/, int /*level*/, const char* /*message*/) {});
    projection_.reset(proj_create(context_.get(), text.c_str()));
  }

  [[nodiscard]] bool is_usable() const {
    return projection_ && proj_angular_input(projection_.get(), PJ_FWD) != 0 &&
           proj_pj_info(projection_.get()).has_inverse != 0;
  }
  [[nodiscard]] MapPoint forward(const LonLat& lon_lat) const override {
    const PJ_COORD point =
        proj_trans(projection_.get(), PJ_FWD, proj_coord(lon_lat.lon_rad, lon_lat.lat_rad, 0, 0));
    if (!std::isfinite(point.xy.x) || !std::isfinite(point.xy.y)) return {kNoPlace, kNoPlace};
    return {point.xy.x, point.xy.y};
  }
  [[nodiscard]] LonLat inverse(const MapPoint& point) const override {
    const PJ_COORD lon_lat = proj_trans(projection_.get(), PJ_INV, proj_coord(point.x, point.y, 0, 0));
    if (!std::isfinite(lon_lat.lp.lam) || !std::isfinite(lon_lat.lp.phi)) return {kNoPlace, kNoPlace};
    return {lon_lat.lp.lam, lon_lat.lp.phi};
  }

 private:
  struct Destroys {
    void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
    void operator()(PJ* projection) const { proj_destroy(projection); }
  };
  std::unique_ptr<PJ_CONTEXT, Destroys> context_;
  std::unique_ptr<PJ, Destroys> projection_;
};

/// By GDAL, for any CRS.
class ByGdal final : public MapProjection::Transformation {
 public:
  ByGdal(const OGRSpatialReference& geographic, const OGRSpatialReference& map)
      : forward_(OGRCreateCoordinateTransformation(&geographic, &map)),
        inverse_(forward_ ? forward_->GetInverse() : nullptr),
        radians_(geographic.GetAngularUnits()) {}

  [[nodiscard]] bool is_usable() const { return inverse_ != nullptr; }
  [[nodiscard]] MapPoint forward(const LonLat& lon_lat) const override {
    return transformed(*forward_, lon_lat.lon_rad / radians_, lon_lat.lat_rad / radians_);
  }
  [[nodiscard]] LonLat inverse(const MapPoint& point) const override {
    const MapPoint angles = transformed(*inverse_, point.x, point.y);
    return {angles.x * radians_, angles.y * radians_};
  }

 private:
  /// x and y transformed; NaN where it fails.
  static MapPoint transformed(OGRCoordinateTransformation& transformation, double x, double y) {
    int done = 0;
    if (transformation.TransformWithErrorCodes(1, &x, &y, nullptr, nullptr, &done) == FALSE || done != 0 ||
        !std::isfinite(x) || !std::isfinite(y))
      return {kNoPlace, kNoPlace};
    return {x, y};
  }

  std::unique_ptr<OGRCoordinateTransformation> forward_, inverse_;
  double radians_;
};

}  // namespace

Ellipsoid body_of(const OGRSpatialReference& crs) {
  const double inverse_flattening = crs.GetInvFlattening();
  return {crs.GetSemiMajor(), inverse_flattening > 0 ? 1 / inverse_flattening : 0};
}

std::optional<MapProjection> MapProjection::of(const OGRSpatialReference& crs) {
  if (crs.IsProjected() == 0) return std::nullopt;
  OGRSpatialReference map = crs;
  map.StripVertical();
  if (const std::optional<std::string> text = projection_text(map))
    if (auto by_proj = std::make_shared<ByProj>(*text); by_proj->is_usable())
      return MapProjection(std::move(by_proj), body_of(map));
  return by_gdal(crs);
}

std::optional<MapProjection> MapProjection::by_gdal(const OGRSpatialReference& crs) {
  OGRSpatialReference map = crs;
  map.StripVertical();
  map.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRSpatialReference> geographic(map.CloneGeogCS());
  if (!geographic) return std::nullopt;
  geographic->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  auto by_gdal = std::make_shared<ByGdal>(*geographic, map);
  if (!by_gdal->is_usable()) return std::nullopt;
  return MapProjection(std::move(by_gdal), body_of(map));
}

MapPoint MapProjection::map_point(const LonLat& lon_lat) const { return transformation_->forward(lon_lat); }

LonLat MapProjection::lon_lat(const MapPoint& point) const { return transformation_->inverse(point); }

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
