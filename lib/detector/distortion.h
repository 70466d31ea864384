// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

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

}  // namespace landfall
