// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D105, D106, D107, D109, D190, D254
#include "chain/terrain/features/added_shapes.h"

namespace landfall {

double Crater::fresh_depth_m(double diameter_m) {
  struct SizeClass {
    double from_m;
    double depth_per_diameter;
  };
  constexpr SizeClass kClasses[] = {{400, 0.21}, {200, 0.17}, {100, 0.15}, {40, 0.13}, {10, 0.11}};
  for (const SizeClass& size : kClasses)
    if (diameter_m >= size.from_m) return size.depth_per_diameter * diameter_m;
  return 0.10 * diameter_m;
}

void Crater::validate(const std::string& owner) const {
  require_positive({owner, "diameter_m"}, diameter_m);
  const double max_m = kDeepestPerDiameter * diameter_m;
  require(depth_m >= 0 && depth_m <= max_m, {owner, "depth_m"}, depth_m,
          ("in [0, " + number_text(max_m) + "]: the profile's depth is 0.2656 diameters").c_str());
  require(freshness > 0 && freshness <= 1, {owner, "freshness"}, freshness, "in (0, 1]");
}

double Crater::relief_m(const Offset& offset) const {
  const double x = portable::hypot(offset.x_m, offset.y_m) / (diameter_m / 2);
  if (x > 1.5) return kNoRelief;
  const double depth = full_depth_m() / diameter_m;
  const double height = std::min(depth / kFullRimDepthPerDiameter, 1.0);  // of the profile, 1: as published
  const double scale_m = freshness * diameter_m * height;
  if (x > 1.02) return scale_m * (0.188253307 + x * (-0.187050452 + x * (0.01844746 + x * 0.01505647)));
  if (x > 0.98) return scale_m * kRimPerDiameter;
  const double bowl = -0.228809953 + x * (0.227533882 + x * (0.083116795 - x * 0.039499407));
  return scale_m * std::max(bowl, kRimPerDiameter - depth / height);
}

void Fracture::validate(const std::string& owner) const {
  require_positive({owner, "length_m"}, length_m);
  require_not_negative({owner, "depth_m"}, depth_m);
  require_not_negative({owner, "width_m"}, width_m);
  require((width_m > 0) == (depth_m > 0), {owner, "width_m"}, width_m,
          depth_m > 0 ? "positive (a trough needs a width)" : "0, where depth_m is 0");
  require_finite({owner, "throw_m"}, throw_m);
  require(depth_m > 0 || throw_m != 0, {owner, "depth_m"}, depth_m, "positive, where throw_m is 0 too");
  require_not_negative({owner, "fade_m"}, fade_m);
  require(fade_m > 0 || throw_m == 0, {owner, "fade_m"}, fade_m, "positive (a cliff fades out over it)");
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
