// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D73, D328
#include "scanner/mechanism_timing.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"
#include "base/portable_math.h"

namespace landfall {
namespace {

constexpr double kTimeRounding_s = 1e-9;
/// e^-40 = 4e-18 is less than the rounding of an angle.
constexpr double kSettledExponent = 40;

}  // namespace

double transfer_time_s(double ahead_rad, double closing_radps, double acceleration_radps2) {
  const double a = acceleration_radps2;
  const double u = closing_radps;
  const double sign = ahead_rad < u * std::abs(u) / (2 * a) ? -1 : 1;
  return (2 * std::sqrt(std::max(0.0, u * u / 2 + sign * a * ahead_rad)) - sign * u) / a;
}

MechanismTiming::MechanismTiming(const MechanismTimingParameters& parameters) : parameters_(parameters) {
  const MechanismTimingParameters& p = parameters;
  require_not_negative({"", "turnaround_time_s"}, p.turnaround_time_s);
  require_not_negative({"", "settle_time_s"}, p.settle_time_s);
  require(p.settle_damping > 0 && p.settle_damping < 1, {"", "settle_damping"}, p.settle_damping,
          "in (0, 1)");
  require_not_negative({"", "max_acceleration_radps2"}, p.max_acceleration_radps2);
  if (p.settle_time_s == 0) return;
  const double root = std::sqrt(1 - p.settle_damping * p.settle_damping);
  decay_per_s_ = 3 / p.settle_time_s;
  sine_share_ = p.settle_damping / root;
  damped_radps_ = decay_per_s_ / sine_share_;
}

bool MechanismTiming::blanks(double since_jump_s) const {
  return since_jump_s + kTimeRounding_s < parameters_.turnaround_time_s;
}

bool MechanismTiming::is_moving(double since_jump_s, const AxesJump& jump) const {
  const double a = parameters_.max_acceleration_radps2;
  if (a == 0) return false;
  // The aim moves on as if it had come to the first pulse with the rate that it has after it.
  const auto time_s = [&](double before, double rate_before, double after, double rate_after) {
    return transfer_time_s(after - rate_after * jump.interval_s - before, rate_before - rate_after, a);
  };
  const double needed_s = std::max(time_s(jump.before.angle_1_rad, jump.rate_before.angle_1_rad,
                                          jump.after.angle_1_rad, jump.rate_after.angle_1_rad),
                                   time_s(jump.before.angle_2_rad, jump.rate_before.angle_2_rad,
                                          jump.after.angle_2_rad, jump.rate_after.angle_2_rad));
  return since_jump_s + jump.interval_s + kTimeRounding_s < needed_s;
}

double MechanismTiming::step_left(double since_jump_s) const {
  if (parameters_.settle_time_s == 0) return 0;
  const double exponent = decay_per_s_ * since_jump_s;
  if (exponent > kSettledExponent) return 0;
  const double phase = damped_radps_ * since_jump_s;
  return portable::exp(-exponent) * (portable::cos(phase) + sine_share_ * portable::sin(phase));
}

}  // namespace landfall
