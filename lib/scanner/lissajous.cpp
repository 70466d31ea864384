// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/lissajous.h"

#include <numbers>

#include "base/parameter_check.h"
#include "base/portable_math.h"

namespace landfall {

Lissajous::Lissajous(const LissajousParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  for (const double half : parameters.half_width_m) require_positive({"", "half_width_m"}, half);
  for (const double rate : parameters.rates_hz) require_not_negative({"", "rates_hz"}, rate);
  require_finite({"", "phase_deg"}, parameters.phase_rad);
}

std::optional<Point<DemFrame>> Lissajous::ground_aim(const PulseTime& pulse) const {
  const auto& [width_x, width_y] = parameters_.half_width_m;
  const auto& [rate_x, rate_y] = parameters_.rates_hz;
  const double turn = 2 * std::numbers::pi;
  return Point<DemFrame>{
      {width_x * portable::sin(turn * (rate_x * pulse.since_start_s) + parameters_.phase_rad),
       width_y * portable::sin(turn * (rate_y * pulse.since_start_s)), 0}};
}

}  // namespace landfall
