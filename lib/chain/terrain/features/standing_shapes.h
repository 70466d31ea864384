// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"
#include "chain/terrain/features/shape.h"

namespace landfall {

/// A right circular cone: height_m (1 - r / radius_m) for r <= radius_m.
struct Cone {
  static constexpr const char* kName = "cone";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double radius_m = 3;
  double height_m = 10;

  /// Throws UsageError unless both are finite and positive.
  void validate(const std::string& owner) const {
    require_positive({owner, "radius_m"}, radius_m);
    require_positive({owner, "height_m"}, height_m);
  }
  [[nodiscard]] double reach_m() const { return radius_m; }
  [[nodiscard]] FeatureSize size() const { return {2 * radius_m, height_m, 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    const double r_m = portable::hypot(offset.x_m, offset.y_m);
    return r_m <= radius_m ? height_m * (1 - r_m / radius_m) : kNoRelief;
  }
  friend bool operator==(const Cone&, const Cone&) = default;
};

/// A hemisphere, flat side down: sqrt(radius_m^2 - r^2) for r <= radius_m.
struct Hemisphere {
  static constexpr const char* kName = "hemisphere";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double radius_m = 1;

  /// Throws UsageError unless the radius is finite and positive.
  void validate(const std::string& owner) const { require_positive({owner, "radius_m"}, radius_m); }
  [[nodiscard]] double reach_m() const { return radius_m; }
  [[nodiscard]] FeatureSize size() const { return {2 * radius_m, radius_m, 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    const double r_m = portable::hypot(offset.x_m, offset.y_m);
    return r_m <= radius_m ? std::sqrt((radius_m - r_m) * (radius_m + r_m)) : kNoRelief;
  }
  friend bool operator==(const Hemisphere&, const Hemisphere&) = default;
};

/// A pyramid on a square base of edge base_width_m, turned counter-clockwise by yaw_rad:
/// height_m (1 - 2 max(|u|, |v|) / base_width_m), (u, v) the point in the base's own axes.
struct Pyramid {
  static constexpr const char* kName = "pyramid";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double base_width_m = 2;
  double height_m = 1;
  double yaw_rad = 0;

  /// Throws UsageError unless width and height are finite and positive and the yaw finite.
  void validate(const std::string& owner) const {
    require_positive({owner, "base_width_m"}, base_width_m);
    require_positive({owner, "height_m"}, height_m);
    require_finite({owner, "yaw_rad"}, yaw_rad);
  }
  /// Half the diagonal of the base, which covers any yaw.
  [[nodiscard]] double reach_m() const { return portable::hypot(base_width_m, base_width_m) / 2; }
  [[nodiscard]] FeatureSize size() const { return {base_width_m, height_m, yaw_rad}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    return own_relief_m(TurnedAxes(yaw_rad).own(offset));
  }
  [[nodiscard]] double own_relief_m(const Offset& own) const {
    const double edge_frac = 2 * std::max(std::abs(own.x_m), std::abs(own.y_m)) / base_width_m;
    return edge_frac <= 1 ? height_m * (1 - edge_frac) : kNoRelief;
  }
  friend bool operator==(const Pyramid&, const Pyramid&) = default;
};

/// The part of a half-buried ellipsoid above the ground: height_m sqrt(1 - (u / a)^2 - (v / b)^2), with the
/// horizontal semi-axes a = diameter_m / 2 along the yaw and b = axis_ratio a across it.
struct Rock {
  static constexpr const char* kName = "rock";
  static constexpr FeatureRole kRole = FeatureRole::stands;

  double diameter_m = 1;
  double height_m = 0.5;
  double axis_ratio = 0.8;
  double yaw_rad = 0;
  /// The diameter in the size law, of a rock that one gives, which is that of a disc of the same area.
  /// None, 0, means diameter_m.
  double law_diameter_m = 0;

  /// Throws UsageError unless diameter and height are finite and positive, the ratio is in (0, 1] and the yaw
  /// finite.
  void validate(const std::string& owner) const {
    require_positive({owner, "diameter_m"}, diameter_m);
    require_positive({owner, "height_m"}, height_m);
    require(axis_ratio > 0 && axis_ratio <= 1, {owner, "axis_ratio"}, axis_ratio, "in (0, 1]");
    require_finite({owner, "yaw_rad"}, yaw_rad);
  }
  [[nodiscard]] double reach_m() const { return diameter_m / 2; }
  [[nodiscard]] FeatureSize size() const {
    return {law_diameter_m > 0 ? law_diameter_m : diameter_m, height_m, yaw_rad};
  }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    return own_relief_m(TurnedAxes(yaw_rad).own(offset));
  }
  [[nodiscard]] double own_relief_m(const Offset& own) const {
    const double a_m = diameter_m / 2;
    const double u = own.x_m / a_m;
    const double v = own.y_m / (axis_ratio * a_m);
    const double r2 = u * u + v * v;
    return r2 <= 1 ? height_m * std::sqrt(1 - r2) : kNoRelief;
  }
  friend bool operator==(const Rock&, const Rock&) = default;
};

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
