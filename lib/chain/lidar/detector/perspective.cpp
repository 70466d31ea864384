// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D95
#include "chain/lidar/detector/perspective.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "base/core/error.h"
#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

/// The derivative of r factor(r^2), at s = r^2.
double growth(const RadialDistortion& d, double s) {
  return 1 + s * (3 * d.k1 + s * (5 * d.k2 + s * 7 * d.k3));
}

/// The points in [0, limit] at which growth() is stationary: the roots of 3 k1 + 10 k2 s + 21 k3 s^2, and
/// both ends.
std::array<double, 4> turning_points(const RadialDistortion& d, double limit) {
  const double a = 21 * d.k3;
  const double half_b = 5 * d.k2;
  const double c = 3 * d.k1;
  // This form avoids cancellation: one root is q/a, the other c/q.
  const double root = std::sqrt(std::max(half_b * half_b - a * c, 0.0));
  const double q = -(half_b + std::copysign(root, half_b));
  const auto inside = [limit](double s) { return s > 0 && s < limit ? s : 0.0; };
  std::array<double, 4> points = {0, inside(q / a), inside(c / q), limit};
  std::sort(points.begin(), points.end());
  return points;
}

/// The root of growth() where it falls from positive at `low` to not positive at `high`.
double falling_root(const RadialDistortion& d, double low, double high) {
  for (double middle = (low + high) / 2; middle > low && middle < high; middle = (low + high) / 2)
    (growth(d, middle) > 0 ? low : high) = middle;
  return high;
}

constexpr int kMaxPixelsPerAxis = 4096;
constexpr int kMaxSubpixels = 64;
constexpr std::int64_t kMaxSamples = std::int64_t{1} << 26;

/// Pixel pitch in tangent units, per image axis.
struct Pitch {
  double x;
  double y;
};

double pitch_of(double ifov_rad) {
  require_positive({"", "ifov_rad"}, ifov_rad);
  return ifov_rad;
}

double pitch_of(double fov_rad, int pixels) {
  require_angle(fov_rad > 0 && fov_rad < std::numbers::pi, {"", "fov_deg"}, fov_rad, "between 0 and 180");
  return 2 * portable::tan(fov_rad / 2) / pixels;
}

Pitch pitch_of(const PerspectiveParameters& p) {
  if (const auto* ifov = std::get_if<PixelFieldOfView>(&p.field_of_view))
    return {pitch_of(ifov->x_rad), pitch_of(ifov->y_rad)};
  const auto& fov = std::get<FullFieldOfView>(p.field_of_view);
  return {pitch_of(fov.x_rad, p.columns), pitch_of(fov.y_rad, p.rows)};
}

void check_perspective(const PerspectiveParameters& p) {
  require(p.rows >= 1 && p.rows <= kMaxPixelsPerAxis, {"", "rows"}, p.rows, "in 1..4096");
  require(p.columns >= 1 && p.columns <= kMaxPixelsPerAxis, {"", "columns"}, p.columns, "in 1..4096");
  require(p.subpixels >= 1 && p.subpixels <= kMaxSubpixels, {"", "subpixels"}, p.subpixels, "in 1..64");
  const std::int64_t samples = std::int64_t{p.rows} * p.columns * p.subpixels * p.subpixels;
  require(samples <= kMaxSamples, {"", "rows x columns x subpixels^2"}, static_cast<double>(samples),
          "at most 67108864");
  require_finite({"", "roll_deg"}, p.roll_rad);
  require(p.fill_factor > 0 && p.fill_factor <= 1, {"", "fill_factor"}, p.fill_factor, "in (0, 1]");
  require_finite({"distortion", "k1"}, p.distortion.k1);
  require_finite({"distortion", "k2"}, p.distortion.k2);
  require_finite({"distortion", "k3"}, p.distortion.k3);
  const std::size_t pixels = static_cast<std::size_t>(p.rows) * static_cast<std::size_t>(p.columns);
  require(p.points.empty() || p.points.size() == pixels, {"", "points"}, static_cast<double>(p.points.size()),
          "rows x columns");
}

/// Offset of item `i` of `count` from their middle, in items.
double from_middle(int i, int count) { return i - (count - 1) / 2.0; }

/// A point on the image plane, tangent units: an ImagePoint with v counted downwards, like rows.
struct Spot {
  double right;
  double down;
};

/// The positions of pixels and their sub-pixels, before distortion.
class PixelGrid {
 public:
  explicit PixelGrid(const PerspectiveParameters& parameters)
      : p_(parameters), pitch_(pitch_of(parameters)), filled_(std::sqrt(parameters.fill_factor)) {}

  /// `right` and `down`: from the pixel's centre, in pixels.
  [[nodiscard]] Spot at(PixelIndex pixel, double right, double down) const {
    if (p_.points.empty())
      return {(from_middle(pixel.col, p_.columns) + right) * pitch_.x,
              (from_middle(pixel.row, p_.rows) + down) * pitch_.y};
    const std::size_t row = static_cast<std::size_t>(pixel.row) * static_cast<std::size_t>(p_.columns);
    const ImagePoint& point = p_.points[row + static_cast<std::size_t>(pixel.col)];
    return {point.u + right * pitch_.x, -point.v + down * pitch_.y};
  }

  /// The position of sub-pixel `i` (row-major) of the pixel.
  [[nodiscard]] Spot sample(PixelIndex pixel, int i) const {
    const int m = p_.subpixels;
    return at(pixel, from_middle(i % m, m) * filled_ / m, from_middle(i / m, m) * filled_ / m);
  }

 private:
  const PerspectiveParameters& p_;
  Pitch pitch_;
  double filled_;  ///< edge of the sensitive area, in pixels
};

/// Turns a point on the image plane into a direction.
class Optics {
 public:
  Optics(const RadialDistortion& distortion, double roll_rad)
      : distortion_(distortion), cos_(portable::cos(roll_rad)), sin_(portable::sin(roll_rad)) {}

  [[nodiscard]] Direction<LidarFrame> look(const Spot& spot) const {
    const double factor = distortion_.factor(spot.right * spot.right + spot.down * spot.down);
    const double x = spot.right * factor;
    const double y = spot.down * factor;
    return Direction<LidarFrame>::of({{x * cos_ + y * sin_, y * cos_ - x * sin_, 1}});
  }

 private:
  RadialDistortion distortion_;
  double cos_;
  double sin_;
};

template <class Visit>
void for_each_pixel(const PerspectiveParameters& p, const Visit& visit) {
  for (int row = 0; row < p.rows; ++row)
    for (int col = 0; col < p.columns; ++col) visit(PixelIndex{row, col});
}

/// How far from the boresight the farthest corner of a pixel lies, tangent units.
double outer_radius(const PerspectiveParameters& parameters, const PixelGrid& grid) {
  double radius = 0;
  for_each_pixel(parameters, [&](PixelIndex pixel) {
    for (const double right : {-0.5, 0.5})
      for (const double down : {-0.5, 0.5}) {
        const Spot corner = grid.at(pixel, right, down);
        radius = std::max(radius, portable::hypot(corner.right, corner.down));
      }
  });
  return radius;
}

void require_no_fold(const PerspectiveParameters& parameters, const PixelGrid& grid) {
  const RadialDistortion& d = parameters.distortion;
  if (d.k1 == 0 && d.k2 == 0 && d.k3 == 0) return;
  const double radius = outer_radius(parameters, grid);
  const auto fold = fold_radius(d, radius);
  if (!fold) return;
  throw UsageError("distortion: the image folds at radius " + number_text(*fold) +
                   ", which is not beyond the detector's outer radius " + number_text(radius) +
                   " (tangent units)");
}

}  // namespace

std::optional<double> fold_radius(const RadialDistortion& distortion, double radius) {
  const std::array<double, 4> s = turning_points(distortion, radius * radius);
  for (std::size_t i = 1; i < s.size(); ++i)
    if (!(growth(distortion, s[i]) > 0)) return std::sqrt(falling_root(distortion, s[i - 1], s[i]));
  return std::nullopt;
}

Detector perspective_detector(const PerspectiveParameters& parameters) {
  check_perspective(parameters);
  const PixelGrid grid(parameters);
  require_no_fold(parameters, grid);
  const Optics optics(parameters.distortion, parameters.roll_rad);
  const int m = parameters.subpixels;
  std::vector<Direction<LidarFrame>> pixels;
  std::vector<Direction<LidarFrame>> samples;
  for_each_pixel(parameters, [&](PixelIndex pixel) {
    pixels.push_back(optics.look(grid.at(pixel, 0, 0)));
    for (int i = 0; m > 1 && i < m * m; ++i) samples.push_back(optics.look(grid.sample(pixel, i)));
  });
  return Detector({parameters.rows, parameters.columns, m}, std::move(pixels), std::move(samples),
                  RangeEstimator(parameters.estimator));
}

}  // namespace landfall
