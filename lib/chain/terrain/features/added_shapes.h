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

/// A bowl crater with a raised rim: the fresh profile of Fassett and Thomson (2014, J. Geophys. Res. Planets
/// 119, 2255-2271) with the level rim that NASA's synthterrain gives it; h D in metres, D = diameter_m (rim
/// to rim), x = r / (D / 2):
///
///   x <= 0.98         -0.228809953 + 0.227533882 x + 0.083116795 x^2 - 0.039499407 x^3
///   0.98 < x <= 1.02   0.036822095
///   1.02 < x <= 1.5    0.188253307 - 0.187050452 x + 0.01844746 x^2 + 0.01505647 x^3
///   beyond             none
///
/// A crater that is shallower than the profile with its rim would be keeps the ratio of rim height to depth
/// of fresh craters, 0.036 / 0.196 (Pike 1977, in Impact and Explosion Cratering, 489-509): the profile is
/// multiplied by depth_m / (kFullRimDepthPerDiameter D) where this is below 1. Where it would still go deeper
/// than depth_m below the rim, the floor is level at that depth. As published, the pieces meet at 0.98 and
/// end in 0 at 1.5 (both within 1e-9 D), but drop by 0.00418947 D at 1.02. Degradation multiplies the whole
/// profile by `freshness`.
struct Crater {
  static constexpr const char* kName = "crater";
  static constexpr FeatureRole kRole = FeatureRole::adds;
  static constexpr double kRimPerDiameter = 0.036822095;
  /// The depth of the profile below the rim at the centre, which is the greatest possible depth.
  static constexpr double kDeepestPerDiameter = 0.228809953 + kRimPerDiameter;
  /// From this depth on the rim has its full height.
  static constexpr double kFullRimDepthPerDiameter = kRimPerDiameter * 0.196 / 0.036;

  double diameter_m = 10;
  double depth_m = 0;  ///< rim to floor before `freshness`; 0: as in a fresh crater of this size
  double freshness = 1;

  /// Depth of a fresh crater, rim to floor. The ratio of depth to diameter is constant within classes of
  /// diameter: 0.13 from 40 m, 0.15 from 100 m, 0.17 from 200 m, 0.21 from 400 m (Stopar et al. 2017, Icarus
  /// 298, 34-48); below them, as in synthterrain, 0.11 from 10 m and 0.10 under 10 m.
  [[nodiscard]] static double fresh_depth_m(double diameter_m);

  /// Throws UsageError unless the diameter is finite and positive, 0 <= depth_m <= kDeepestPerDiameter
  /// diameter_m, and the freshness is in (0, 1].
  void validate(const std::string& owner) const;
  [[nodiscard]] double reach_m() const { return 0.75 * diameter_m; }
  /// The height is minus the remaining depth, rim to floor.
  [[nodiscard]] FeatureSize size() const { return {diameter_m, -freshness * full_depth_m(), 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const;
  friend bool operator==(const Crater&, const Crater&) = default;

 private:
  [[nodiscard]] double full_depth_m() const { return depth_m > 0 ? depth_m : fresh_depth_m(diameter_m); }
};

/// A round hole without a rim: -min(depth_m, (diameter_m / 2 - r) tan wall_slope) for r <= diameter_m / 2.
/// The floor is level; walls that meet before depth_m form a cone. A wall of 90 deg falls within one cell.
struct Pit {
  static constexpr const char* kName = "pit";
  static constexpr FeatureRole kRole = FeatureRole::adds;

  double diameter_m = 10;
  double depth_m = 5;
  double wall_slope_rad = std::numbers::pi / 2;  ///< from the horizontal

  /// Throws UsageError unless diameter and depth are finite and positive and the slope in (0, pi/2].
  void validate(const std::string& owner) const {
    require_positive({owner, "diameter_m"}, diameter_m);
    require_positive({owner, "depth_m"}, depth_m);
    require(wall_slope_rad > 0 && wall_slope_rad <= std::numbers::pi / 2, {owner, "wall_slope_rad"},
            wall_slope_rad, "in (0, pi/2]");
  }
  [[nodiscard]] double reach_m() const { return diameter_m / 2; }
  [[nodiscard]] FeatureSize size() const { return {diameter_m, relief_m({}), 0}; }
  [[nodiscard]] double relief_m(const Offset& offset) const {
    const double inside_m = diameter_m / 2 - portable::hypot(offset.x_m, offset.y_m);
    return inside_m >= 0 ? -std::min(depth_m, inside_m * std::abs(portable::tan(wall_slope_rad))) : kNoRelief;
  }
  friend bool operator==(const Pit&, const Pit&) = default;
};

/// A crack along its u axis (turned counter-clockwise from +x by yaw_rad): a trough, a cliff, or both.
///
///   trough   -min(depth_m, (width_m / 2 - |v|) tan wall_slope)             for |v| <= width_m / 2
///   cliff    sign(throw_m) min(|throw_m|, v tan wall_slope) taper(fade_m - v, fade_m)  for 0 <= v <= fade_m
///
/// Their sum is multiplied by taper(length_m / 2 - |u|, taper_m) of shape.h, |u| <= length_m / 2. The trough
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
