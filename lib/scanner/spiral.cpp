// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D77
#include "scanner/spiral.h"

#include <cmath>
#include <numbers>

#include "base/parameter_check.h"
#include "base/portable_math.h"

namespace landfall {
namespace {

/// The fraction of the way outwards: 0 .. 1 and back again in every two periods.
double share_of_way(double periods) {
  const double in_cycle = periods - 2 * std::floor(periods / 2);
  return in_cycle <= 1 ? in_cycle : 2 - in_cycle;
}

}  // namespace

Spiral::Spiral(const SpiralParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  const SpiralParameters& p = parameters;
  require_positive({"", "radius_m"}, p.radius_m);
  require_positive({"", "pitch_m"}, p.pitch_m);
  require(p.inner_radius_m >= 0 && p.inner_radius_m < p.radius_m, {"", "inner_radius_m"}, p.inner_radius_m,
          ">= 0 and below radius_m");
  require_positive({"", "period_s"}, p.period_s);
}

std::optional<Point<DemFrame>> Spiral::ground_aim(const PulseTime& pulse) const {
  const SpiralParameters& p = parameters_;
  const double share = share_of_way(pulse.since_start_s / p.period_s);
  const double outward = p.direction == SpiralDirection::outward ? share : 1 - share;
  const double inner = p.inner_radius_m * p.inner_radius_m;
  const double radius = std::sqrt(inner + (p.radius_m * p.radius_m - inner) * outward);
  const double azimuth = 2 * std::numbers::pi * (radius / p.pitch_m);
  return Point<DemFrame>{{radius * portable::cos(azimuth), radius * portable::sin(azimuth), 0}};
}

}  // namespace landfall
