// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "terrain/features/feature_role.h"

namespace landfall {

/// A crack along its u axis (turned counter-clockwise from +x by yaw_rad): a trough, a cliff, or both.
///
///   trough   -min(depth_m, (width_m / 2 - |v|) tan wall_slope)             for |v| <= width_m / 2
///   cliff    sign(throw_m) min(|throw_m|, v tan wall_slope) taper(fade_m - v, fade_m)  for 0 <= v <= fade_m
///
/// Their sum is multiplied by taper(length_m / 2 - |u|, taper_m) of taper.h, |u| <= length_m / 2. The trough
/// has a level floor, or is V-shaped where its walls meet before depth_m. The cliff raises (lowers, for a
/// negative throw) the ground on the +v side, which returns to its level at fade_m. Walls of 90 deg fall
/// within one cell of the grid.
struct Fracture {
  static constexpr const char* kName = "fracture";
  static constexpr FeatureRole kRole = FeatureRole::adds;

  double length_m = 100;
  double width_m = 2;
  double depth_m = 2;
  double throw_m = 0;
  double fade_m = 50;
  double wall_slope_rad = 1.5;  ///< from the horizontal
  double taper_m = 10;          ///< length of each tapered end
  double yaw_rad = 0;

  /// Throws UsageError unless the length is finite and positive, the slope is in (0, pi/2], 0 <= taper_m <=
  /// length_m / 2, the rest is finite, width and depth are both positive or both 0, throw or depth is not 0,
  /// and fade_m is positive for a non-zero throw.
  void validate(const std::string& owner) const;
  [[nodiscard]] double reach_m() const;
  /// The height is minus the depth of the trough or, without a trough, the throw.
  [[nodiscard]] FeatureSize size() const;
  [[nodiscard]] double relief_m(const Offset& offset) const;
  [[nodiscard]] double own_relief_m(const Offset& own) const;
  friend bool operator==(const Fracture&, const Fracture&) = default;

 private:
  [[nodiscard]] double northern_reach_m() const;
  [[nodiscard]] double trough_m(double v_m) const;
  [[nodiscard]] double cliff_m(double v_m) const;
};

}  // namespace landfall
