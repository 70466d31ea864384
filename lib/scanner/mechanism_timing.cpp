// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/mechanism_timing.h"

#include <cmath>

#include "base/parameter_check.h"

namespace landfall {
namespace {

constexpr double kTimeRounding_s = 1e-9;
/// e^-40 = 4e-18 is less than the rounding of an angle.
constexpr double kSettledExponent = 40;

}  // namespace

MechanismTiming::MechanismTiming(const MechanismTimingParameters& parameters) : parameters_(parameters) {
  const MechanismTimingParameters& p = parameters;
  require_not_negative({"", "turnaround_time_s"}, p.turnaround_time_s);
  require_not_negative({"", "settle_time_s"}, p.settle_time_s);
  require(p.settle_damping > 0 && p.settle_damping < 1, {"", "settle_damping"}, p.settle_damping,
          "in (0, 1)");
  if (p.settle_time_s == 0) return;
  const double root = std::sqrt(1 - p.settle_damping * p.settle_damping);
  decay_per_s_ = 3 / p.settle_time_s;
  sine_share_ = p.settle_damping / root;
  damped_radps_ = decay_per_s_ / sine_share_;
}

bool MechanismTiming::blanks(double since_jump_s) const {
  return since_jump_s + kTimeRounding_s < parameters_.turnaround_time_s;
}

double MechanismTiming::step_left(double since_jump_s) const {
  if (parameters_.settle_time_s == 0) return 0;
  const double exponent = decay_per_s_ * since_jump_s;
  if (exponent > kSettledExponent) return 0;
  const double phase = damped_radps_ * since_jump_s;
  return std::exp(-exponent) * (std::cos(phase) + sine_share_ * std::sin(phase));
}

}  // namespace landfall
