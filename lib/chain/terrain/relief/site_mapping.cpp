// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D373, D436
#include "chain/terrain/relief/site_mapping.h"

#include <cmath>
#include <utility>

#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

/// Cosine of the largest angle from the centre: 90 degrees but for rounding (microns on the ground).
constexpr double kHorizonCosine = 1e-12;

}  // namespace

GeoTransform::GeoTransform(const std::array<double, 6>& c) : origin_(c[0], c[3]) {
  cell_ << c[1], c[2], c[4], c[5];
}

bool GeoTransform::invertible() const {
  return origin_.allFinite() && cell_.allFinite() && cell_.determinant() != 0 && cell_.inverse().allFinite();
}

MapPoint GeoTransform::map_point(const PixelPosition& pixel) const {
  const Eigen::Vector2d point = origin_ + cell_ * Eigen::Vector2d(pixel.col + 0.5, pixel.row + 0.5);
  return {point.x(), point.y()};
}

PixelPosition GeoTransform::pixel(const MapPoint& point) const {
  const Eigen::Vector2d corner = cell_.inverse() * (Eigen::Vector2d(point.x, point.y) - origin_);
  return {corner.x() - 0.5, corner.y() - 0.5};
}

OrthographicFrame::OrthographicFrame(const Ellipsoid& body, const LonLat& center)
    : body_(body), center_(center) {
  const double s = portable::sin(center.lat_rad);
  const double c = portable::cos(center.lat_rad);
  const double e2 = body.flattening * (2 - body.flattening);
  const double normal_m = body.semi_major_m / std::sqrt(1 - e2 * s * s);
  origin_m_ = {normal_m * c, 0, normal_m * (1 - e2) * s};
  R_body_plane_ << 0, -s, c,  //
      1, 0, 0,                //
      0, c, s;
}

LonLat OrthographicFrame::difference(const SitePoint& point) const {
  // The normal through the point meets the ellipsoid x^2 + y^2 + z^2 / (1-f)^2 = a^2 at the height h that
  // solves h^2 A + 2 h B + C = 0; the root near the plane is the near side of the body.
  const Eigen::Vector3d up = R_body_plane_.col(2);
  const Eigen::Vector3d p = origin_m_ + point.x_m * R_body_plane_.col(0) + point.y_m * R_body_plane_.col(1);
  const double axis_ratio = 1 - body_.flattening;
  const Eigen::Vector3d stretch(1, 1, 1 / (axis_ratio * axis_ratio));
  const double A = up.dot(stretch.cwiseProduct(up));
  const double B = p.dot(stretch.cwiseProduct(up));
  // The centre lies on the ellipsoid, so its own terms cancel.
  const Eigen::Vector3d step = p - origin_m_;
  const double C = step.dot(stretch.cwiseProduct(p + origin_m_));
  const double h_m = -C / (B + std::sqrt(B * B - A * C));
  const Eigen::Vector3d q = p + h_m * up;
  const double lat_rad = portable::atan2(stretch.z() * q.z(), portable::hypot(q.x(), q.y()));
  return {portable::atan2(q.y(), q.x()), lat_rad - center_.lat_rad};
}

std::optional<SitePoint> OrthographicFrame::point(const LonLat& difference) const {
  const double lat_rad = center_.lat_rad + difference.lat_rad;
  const double s = portable::sin(lat_rad);
  const double c = portable::cos(lat_rad);
  const Eigen::Vector3d normal(c * portable::cos(difference.lon_rad), c * portable::sin(difference.lon_rad),
                               s);
  if (R_body_plane_.col(2).dot(normal) <= kHorizonCosine) return std::nullopt;
  const double e2 = body_.flattening * (2 - body_.flattening);
  const double normal_m = body_.semi_major_m / std::sqrt(1 - e2 * s * s);
  const Eigen::Vector3d surface_m = normal_m * normal.cwiseProduct(Eigen::Vector3d(1, 1, 1 - e2));
  const Eigen::Vector3d step = surface_m - origin_m_;
  return SitePoint{R_body_plane_.col(0).dot(step), R_body_plane_.col(1).dot(step)};
}

SitePoint OrthographicFrame::pole() const {
  const double sign = center_.lat_rad < 0 ? -1 : 1;
  const Eigen::Vector3d p(0, 0, sign * body_.semi_major_m * (1 - body_.flattening));
  return {0, R_body_plane_.col(1).dot(p - origin_m_)};
}

SiteMapping::SiteMapping(const GeoTransform& georeference, const PixelPosition& center,
                         double metres_per_unit)
    : center_(center), pixels_per_step_(georeference.pixels_per_unit() / metres_per_unit) {}

SiteMapping::SiteMapping(const GeoTransform& georeference, const PixelPosition& center,
                         const OrthographicFrame& frame, double radians_per_unit)
    : center_(center), pixels_per_step_(georeference.pixels_per_unit() / radians_per_unit), frame_(frame) {}

SiteMapping::SiteMapping(const PixelPosition& center, const OrthographicFrame& frame, PixelOfLonLat pixel_of)
    : center_(center), pixels_per_step_(Eigen::Matrix2d::Zero()), frame_(frame) {
  const PixelPosition first = pixel_of({0, 0});
  pixel_of_ = [pixel_of = std::move(pixel_of), first](const LonLat& difference) {
    const PixelPosition pixel = pixel_of(difference);
    return PixelPosition{pixel.col - first.col, pixel.row - first.row};
  };
}

PixelPosition SiteMapping::pixel(const SitePoint& point) const {
  if (smooth_) {
    const Eigen::Vector2d pixels = smooth_->at({point.x_m, point.y_m});
    return {center_.col + pixels.x(), center_.row + pixels.y()};
  }
  if (pixel_of_) {
    const PixelPosition pixels = pixel_of_(frame_->difference(point));
    return {center_.col + pixels.col, center_.row + pixels.row};
  }
  Eigen::Vector2d step(point.x_m, point.y_m);
  if (frame_) {
    const LonLat difference = frame_->difference(point);
    step = {difference.lon_rad, difference.lat_rad};
  }
  const Eigen::Vector2d pixels = pixels_per_step_ * step;
  return {center_.col + pixels.x(), center_.row + pixels.y()};
}

std::optional<SiteMapping> SiteMapping::smoothed(double half_width_m) const {
  if (!pixel_of_) return *this;
  constexpr double kTolerance_px = 1e-7;
  const auto exact = [&](const Eigen::Vector2d& point) {
    const PixelPosition pixels = pixel_of_(frame_->difference({point.x(), point.y()}));
    return Eigen::Vector2d(pixels.col, pixels.row);
  };
  SiteMapping mapping = *this;
  mapping.smooth_ = SmoothMap::fitted(exact, half_width_m, kTolerance_px);
  return mapping.smooth_ ? std::optional(mapping) : std::nullopt;
}

std::optional<SitePoint> SiteMapping::pole() const {
  return frame_ && !pixel_of_ ? std::optional(frame_->pole()) : std::nullopt;
}

double SiteMapping::posting_m() const {
  constexpr double kStep_m = 1;
  const PixelPosition east = pixel({kStep_m, 0});
  const PixelPosition west = pixel({-kStep_m, 0});
  const PixelPosition north = pixel({0, kStep_m});
  const PixelPosition south = pixel({0, -kStep_m});
  Eigen::Matrix2d pixels_per_m;
  pixels_per_m << east.col - west.col, north.col - south.col, east.row - west.row, north.row - south.row;
  const Eigen::Matrix2d m_per_pixel = (pixels_per_m / (2 * kStep_m)).inverse();
  return m_per_pixel.colwise().norm().minCoeff();
}

SiteMapping SiteMapping::in_window(const PixelPosition& first) const {
  SiteMapping mapping = *this;
  mapping.center_ = {center_.col - first.col, center_.row - first.row};
  return mapping;
}

}  // namespace landfall
