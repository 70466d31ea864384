// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "chain/lidar/detector/detector.h"
#include "chain/lidar/detector/pixel_table.h"
#include "chain/lidar/detector/range_estimator.h"

namespace landfall {

/// Radial distortion of the optics (Brown 1966, radial part), in tangent units: a pixel at (u, v) looks along
///   (u, v) (1 + k1 r^2 + k2 r^4 + k3 r^6),  r^2 = u^2 + v^2.
/// Negative coefficients pull the corners in (barrel), positive ones push them out (pincushion).
struct RadialDistortion {
  double k1 = 0;
  double k2 = 0;
  double k3 = 0;

  /// 1 + k1 r^2 + k2 r^4 + k3 r^6: exactly 1 without distortion.
  [[nodiscard]] double factor(double r_squared) const {
    return 1 + r_squared * (k1 + r_squared * (k2 + r_squared * k3));
  }
};

/// The smallest radius in (0, radius] at which the distorted radius stops growing: from there on the image
/// folds, so that two pixels look the same way. Empty if it grows everywhere in [0, radius]. Accurate to
/// 1e-12 of the radius. The coefficients must be finite.
[[nodiscard]] std::optional<double> fold_radius(const RadialDistortion& distortion, double radius);

/// The angle of one pixel at the boresight; x along a row of pixels, y along a column. The pitch of the
/// pixels is this number in tangent units.
struct PixelFieldOfView {
  double x_rad = 1.6e-3 / 18;
  double y_rad = 1.6e-3 / 18;
};

/// The whole detector's angle, edge to edge, in (0, pi): pitch = 2 tan(fov / 2) / pixels on that axis.
struct FullFieldOfView {
  double x_rad = 1.6e-3;
  double y_rad = 1.6e-3;
};

struct PerspectiveParameters {
  int rows = 18;     ///< 1 .. 4096
  int columns = 18;  ///< 1 .. 4096
  std::variant<PixelFieldOfView, FullFieldOfView> field_of_view = PixelFieldOfView{};
  int subpixels = 1;    ///< per axis, 1 .. 64; rows x columns x subpixels^2 must not exceed 2^26
  double roll_rad = 0;  ///< turns the pixel grid counter-clockwise on the map, the mount being nominal
  RadialDistortion distortion{};
  /// The fraction of a pixel's area that is sensitive, in (0, 1]: a square at its centre. Without sub-pixels,
  /// a pixel is a single ray and this has no effect.
  double fill_factor = 1;
  /// The centre of each pixel, row-major; empty: evenly, one pitch apart.
  std::vector<ImagePoint> points{};
  RangeEstimatorParameters estimator{};
};

/// A pinhole camera. Pixel (row a, column b) lies at u = (b - (columns - 1)/2) pitch_x, v = ((rows - 1)/2 -
/// a) pitch_y, or at its entry in `points`; its sub-pixels lie at offsets ((p - (m - 1)/2)/m)
/// sqrt(fill_factor) pitch, p = 0 .. m - 1, from it. Each point is moved by the distortion and looks along
/// normalise(u, -v, 1), turned by the roll right-handedly about -z_L.
///
/// Throws UsageError, naming the key and the bound, for a value out of range, for a number of points that
/// differs from the number of pixels, and where the distortion folds the image within a pixel.
[[nodiscard]] Detector perspective_detector(const PerspectiveParameters& parameters);

}  // namespace landfall
