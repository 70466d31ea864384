// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D109, D190
#include "terrain/features/fracture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parameter_check.h"
#include "base/portable_math.h"
#include "terrain/features/taper.h"
#include "terrain/features/turned_axes.h"

namespace landfall {

void Fracture::validate(const std::string& owner) const {
  require_positive({owner, "length_m"}, length_m);
  require_not_negative({owner, "depth_m"}, depth_m);
  require_not_negative({owner, "width_m"}, width_m);
  require((width_m > 0) == (depth_m > 0), {owner, "width_m"}, width_m,
          depth_m > 0 ? "positive, which a trough needs" : "0, where depth_m is 0");
  require_finite({owner, "throw_m"}, throw_m);
  require(depth_m > 0 || throw_m != 0, {owner, "depth_m"}, depth_m, "positive, where throw_m is 0 too");
  require_not_negative({owner, "fade_m"}, fade_m);
  require(fade_m > 0 || throw_m == 0, {owner, "fade_m"}, fade_m, "positive, which a cliff needs");
  require(wall_slope_rad > 0 && wall_slope_rad <= std::numbers::pi / 2, {owner, "wall_slope_rad"},
          wall_slope_rad, "in (0, pi/2]");
  require(taper_m >= 0 && taper_m <= length_m / 2, {owner, "taper_m"}, taper_m, "in [0, length_m / 2]");
  require_finite({owner, "yaw_rad"}, yaw_rad);
}

double Fracture::reach_m() const { return portable::hypot(length_m / 2, northern_reach_m()); }

FeatureSize Fracture::size() const {
  return FeatureSize::of_rectangle(length_m, width_m / 2 + northern_reach_m(),
                                   depth_m == 0 ? throw_m : trough_m(0), yaw_rad);
}

double Fracture::northern_reach_m() const { return std::max(width_m / 2, throw_m == 0 ? 0 : fade_m); }

double Fracture::relief_m(const Offset& offset) const {
  return own_relief_m(TurnedAxes(yaw_rad).own(offset));
}

double Fracture::own_relief_m(const Offset& own) const {
  const double inside_m = length_m / 2 - std::abs(own.x_m);
  const double north_m = northern_reach_m();
  if (!(inside_m >= 0) || own.y_m < -width_m / 2 || own.y_m > north_m) return kNoRelief;
  return (trough_m(own.y_m) + cliff_m(own.y_m)) * taper(inside_m, taper_m);
}

double Fracture::trough_m(double v_m) const {
  const double inside_m = width_m / 2 - std::abs(v_m);
  return inside_m > 0 ? -std::min(depth_m, inside_m * std::abs(portable::tan(wall_slope_rad))) : 0;
}

double Fracture::cliff_m(double v_m) const {
  if (throw_m == 0 || v_m <= 0 || v_m >= fade_m) return 0;
  const double face_m = std::min(std::abs(throw_m), v_m * std::abs(portable::tan(wall_slope_rad)));
  return std::copysign(face_m, throw_m) * taper(fade_m - v_m, fade_m);
}

}  // namespace landfall
