// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "base/numerics/portable_math.h"
#include "chain/terrain/relief/smooth_map.h"
#include "chain/terrain/site_point.h"

namespace landfall {

/// A point in a raster. Integers are pixel centres; (0, 0) is that of the first pixel of the first row.
struct PixelPosition {
  double col = 0;
  double row = 0;
};

/// A point in a raster's coordinate system, its own units: (x, y), or (longitude, latitude).
struct MapPoint {
  double x = 0;
  double y = 0;
};

/// GDAL's affine georeference: pixel corner (col, row) lies at x = c[0] + c[1] col + c[2] row,
/// y = c[3] + c[4] col + c[5] row. Any cell shape, rotation and handedness.
class GeoTransform {
 public:
  explicit GeoTransform(const std::array<double, 6>& coefficients);
  /// False if cells have no area or a coefficient is not finite: no inverse exists.
  [[nodiscard]] bool invertible() const;
  [[nodiscard]] MapPoint map_point(const PixelPosition& pixel) const;
  [[nodiscard]] PixelPosition pixel(const MapPoint& point) const;
  /// The lengths of a pixel's edges, along a row and along a column, map units.
  [[nodiscard]] std::array<double, 2> edges() const {
    return {portable::hypot(cell_(0, 0), cell_(1, 0)), portable::hypot(cell_(0, 1), cell_(1, 1))};
  }
  /// GDAL's six coefficients.
  [[nodiscard]] std::array<double, 6> coefficients() const {
    return {origin_.x(), cell_(0, 0), cell_(0, 1), origin_.y(), cell_(1, 0), cell_(1, 1)};
  }
  /// Pixels (col, row) per map unit (x, y).
  [[nodiscard]] Eigen::Matrix2d pixels_per_unit() const { return cell_.inverse(); }

 private:
  Eigen::Vector2d origin_;
  Eigen::Matrix2d cell_;
};

/// An ellipsoid of revolution; flattening 0 is a sphere.
struct Ellipsoid {
  double semi_major_m = 0;
  double flattening = 0;
};

/// Geodetic coordinates, radians.
struct LonLat {
  double lon_rad = 0;
  double lat_rad = 0;
};

/// The orthographic frame of a body around a centre: the tangent plane at the centre, x east and y north, the
/// surface projected along the centre's normal (EPSG method 9840). Exact for spheres and ellipsoids; metres
/// on the plane are true at the centre and shrink as the cosine of the angular distance.
class OrthographicFrame {
 public:
  OrthographicFrame(const Ellipsoid& body, const LonLat& center);
  /// Longitude and latitude of the surface under a point of the plane, both relative to the centre; NaN
  /// beyond the body's limb. The longitude difference lies in [-pi, pi].
  [[nodiscard]] LonLat difference(const SitePoint& point) const;
  /// The point of the plane over the ground at a longitude and latitude, both relative to the centre: the
  /// inverse of difference(). None beyond the horizon: where the surface's normal is 90 degrees or more from
  /// that of the centre, so that difference() never returns this ground. NaN of NaN.
  [[nodiscard]] std::optional<SitePoint> point(const LonLat& difference) const;
  /// The pole of the centre's hemisphere.
  [[nodiscard]] SitePoint pole() const;

 private:
  Ellipsoid body_;
  LonLat center_;
  Eigen::Vector3d origin_m_;      // of the body, x through the centre's meridian
  Eigen::Matrix3d R_body_plane_;  // columns: north, up; east is the body's y
};

/// The position in a raster of the ground at a longitude and latitude, both relative to a site's centre.
using PixelOfLonLat = std::function<PixelPosition(const LonLat& difference)>;

/// Maps a point of the site to a position in a raster.
class SiteMapping {
 public:
  /// The site's axes are the raster's axes; a unit of the raster is `metres_per_unit` long.
  SiteMapping(const GeoTransform& georeference, const PixelPosition& center, double metres_per_unit);
  /// The raster's coordinates are longitude and latitude in units of `radians_per_unit`; the site's axes are
  /// those of `frame`, which has the same centre.
  SiteMapping(const GeoTransform& georeference, const PixelPosition& center, const OrthographicFrame& frame,
              double radians_per_unit);
  /// A raster in any map projection, which `pixel_of` evaluates; the site's axes are those of `frame`. Call
  /// smoothed() before pixel() is called from several threads or for many points.
  SiteMapping(const PixelPosition& center, const OrthographicFrame& frame, PixelOfLonLat pixel_of);

  [[nodiscard]] PixelPosition pixel(const SitePoint& point) const;
  /// The same mapping for a site of this half width: that of a map projection as a polynomial within 1e-7
  /// pixel of it, others unchanged. None where the projection is not smooth there (a seam, a limb).
  [[nodiscard]] std::optional<SiteMapping> smoothed(double half_width_m) const;
  /// The pole of a raster in longitude and latitude, where it lies on the site's half of the body.
  [[nodiscard]] std::optional<SitePoint> pole() const;
  /// Columns that half a turn of longitude takes; only with a pole().
  [[nodiscard]] double half_turn_px() const { return std::abs(pixels_per_step_(0, 0)) * std::numbers::pi; }
  /// Distance on the site, metres, at its centre, from a pixel's centre to the nearer of its neighbours in
  /// the row and in the column; not finite or 0 if the centre is a pole of the raster's longitudes.
  [[nodiscard]] double posting_m() const;
  /// The mapping to a window of the raster that begins at pixel `first`.
  [[nodiscard]] SiteMapping in_window(const PixelPosition& first) const;

 private:
  PixelPosition center_;
  Eigen::Matrix2d pixels_per_step_;  // per metre, or per radian with a frame
  std::optional<OrthographicFrame> frame_;
  PixelOfLonLat pixel_of_;           // relative to the centre's pixel where smooth_ is not set
  std::optional<SmoothMap> smooth_;  // from metres to pixels from the centre
};

}  // namespace landfall
