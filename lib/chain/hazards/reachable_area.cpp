// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D400
#include "chain/hazards/reachable_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/core/error.h"
#include "base/numerics/portable_math.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kRim_m = 1e-9;
constexpr int kArcSteps = 72;  // of a half circle

double distance(Horizontal a, Horizontal b) { return portable::hypot(a.x - b.x, a.y - b.y); }

Horizontal moved(Horizontal start, Horizontal velocity, double time_s) {
  return {start.x + velocity.x * time_s, start.y + velocity.y * time_s};
}

}  // namespace

ReachableArea::ReachableArea(std::variant<Lens, Polygon> shape) : shape_(std::move(shape)) {}

ReachableArea ReachableArea::circle(double radius_m) {
  return ReachableArea(Lens{{Horizontal{}, Horizontal{}}, radius_m});
}

ReachableArea ReachableArea::polygon(std::vector<Horizontal> vertices) {
  return ReachableArea(Polygon({std::move(vertices)}));
}

ReachableArea ReachableArea::divert(const DivertStart& start) {
  const double time_s = 2 * start.height_m / start.descent_mps;
  const double vertical = start.gravity_mps2 + start.descent_mps * start.descent_mps / (2 * start.height_m);
  const double thrust = start.thrust_accel_mps2;
  if (vertical > thrust)
    throw UsageError("thrust_accel_mps2: " + short_number(thrust) + " does not stop a descent of " +
                     short_number(start.descent_mps) + " m/s within " + short_number(start.height_m) +
                     " m: it takes " + short_number(vertical) + " m/s2 (gravity + descent^2 / 2 height)");
  const double horizontal =
      std::min(vertical * portable::tan(start.tilt_rad), std::sqrt(thrust * thrust - vertical * vertical));
  return ReachableArea(Lens{{moved(start.position_m, start.velocity_mps, time_s / 4),
                             moved(start.position_m, start.velocity_mps, 3 * time_s / 4)},
                            horizontal * time_s * time_s / 4});
}

bool ReachableArea::contains(Horizontal place) const {
  if (const auto* polygon = std::get_if<Polygon>(&shape_)) return polygon->contains(place);
  const auto& lens = std::get<Lens>(shape_);
  return std::ranges::all_of(
      lens.centres, [&](Horizontal centre) { return distance(place, centre) <= lens.radius_m + kRim_m; });
}

std::vector<Horizontal> ReachableArea::outline() const {
  if (const auto* polygon = std::get_if<Polygon>(&shape_)) return polygon->rings().front();
  return outline_of(std::get<Lens>(shape_));
}

std::vector<Horizontal> ReachableArea::outline_of(const Lens& lens) {
  const auto [first, last] = lens.centres;
  const double half_m = distance(first, last) / 2;
  if (half_m > lens.radius_m) return {};
  const double ahead = portable::atan2(last.y - first.y, last.x - first.x);
  const double half_angle = lens.radius_m > 0 ? portable::acos(half_m / lens.radius_m) : 0;
  std::vector<Horizontal> border;
  const auto add_arc = [&](Horizontal centre, double middle) {
    for (int step = 0; step < kArcSteps; ++step) {
      const double angle = middle + half_angle * (2.0 * step / kArcSteps - 1);
      border.push_back(
          {centre.x + lens.radius_m * portable::cos(angle), centre.y + lens.radius_m * portable::sin(angle)});
    }
  };
  add_arc(first, ahead);
  add_arc(last, ahead + std::numbers::pi);
  return border;
}

}  // namespace landfall
