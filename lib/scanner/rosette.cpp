// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/rosette.h"

#include <numbers>

#include "base/parameter_check.h"
#include "base/portable_math.h"

namespace landfall {

Rosette::Rosette(const RosetteParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  require_positive({"", "radius_m"}, parameters.radius_m);
  for (const double rate : parameters.rates_hz) require_finite({"", "rates_hz"}, rate);
  for (const double phase : parameters.phases_rad) require_finite({"", "phases_deg"}, phase);
}

std::optional<Point<DemFrame>> Rosette::ground_aim(const PulseTime& pulse) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle =
        2 * std::numbers::pi * (parameters_.rates_hz[i] * pulse.since_start_s) + parameters_.phases_rad[i];
    sum += Eigen::Vector3d(portable::cos(angle), portable::sin(angle), 0);
  }
  return Point<DemFrame>{parameters_.radius_m / 2 * sum};
}

}  // namespace landfall
