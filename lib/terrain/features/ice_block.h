// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/parameter_check.h"
#include "base/portable_math.h"
#include "terrain/features/feature_role.h"
#include "terrain/features/turned_axes.h"

namespace landfall {

/// A box of ice. Its bottom rests on the ground, length_m along the u axis (turned counter-clockwise from +x
/// by yaw_rad), width_m along v; then it is tilted by tilt_rad about the u axis through the middle of its
/// bottom, so that the +v side rises for a positive tilt and the other side sinks. The relief is the top of
/// the tilted box, |u| <= length_m / 2; with t = |tilt|, v towards the raised side:
///
///   top   (height_m + v sin t) / cos t   for -w - s <= v <= w - s,
///   side  (width_m / 2 - v cos t) / sin t   for w - s < v <= w,
///
/// where w = width_m cos t / 2 and s = height_m sin t. It is negative where the box has sunk in.
struct IceBlock {
  static constexpr const char* kName = "ice_block";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double length_m = 1;
  double width_m = 1;
  double height_m = 1;
  double yaw_rad = 0;
  double tilt_rad = 0;

  /// Throws UsageError unless the three edges are finite and positive, the yaw is finite and the tilt is
  /// within 80 deg.
  void validate(const std::string& owner) const {
    require_positive({owner, "length_m"}, length_m);
    require_positive({owner, "width_m"}, width_m);
    require_positive({owner, "height_m"}, height_m);
    require_finite({owner, "yaw_rad"}, yaw_rad);
    require(std::abs(tilt_rad) <= kMaxTilt_rad, {owner, "tilt_rad"}, tilt_rad, "within 80 deg (1.3963 rad)");
  }
  [[nodiscard]] double reach_m() const { return portable::hypot(length_m / 2, half_span_m()); }
  /// The diameter is the longer side of the footprint, the height is that of the highest edge.
  [[nodiscard]] FeatureSize size() const {
    const double t = std::abs(tilt_rad);
    const double top_m = height_m * portable::cos(t) + width_m / 2 * portable::sin(t);
    const double span_m = width_m * portable::cos(t) + height_m * portable::sin(t);
    return FeatureSize::of_rectangle(length_m, span_m, top_m, yaw_rad);
  }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    return own_relief_m(TurnedAxes(yaw_rad).own(offset));
  }
  [[nodiscard]] double own_relief_m(const Offset& own) const {
    const double sin_t = portable::sin(std::abs(tilt_rad));
    const double cos_t = portable::cos(tilt_rad);
    const double v_m = tilt_rad < 0 ? -own.y_m : own.y_m;
    const double w_m = width_m / 2 * cos_t;
    const double s_m = height_m * sin_t;
    if (std::abs(own.x_m) > length_m / 2 || v_m < -w_m - s_m || v_m > w_m) return kNoRelief;
    return v_m <= w_m - s_m ? (height_m + v_m * sin_t) / cos_t : (width_m / 2 - v_m * cos_t) / sin_t;
  }
  friend bool operator==(const IceBlock&, const IceBlock&) = default;

 private:
  static constexpr double kMaxTilt_rad = 80 * std::numbers::pi / 180 * (1 + 1e-12);

  /// The largest horizontal distance of the box from the u axis.
  [[nodiscard]] double half_span_m() const {
    const double t = std::abs(tilt_rad);
    return width_m / 2 * portable::cos(t) + height_m * portable::sin(t);
  }
};

}  // namespace landfall
