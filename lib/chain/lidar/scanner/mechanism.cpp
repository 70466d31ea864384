// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D73, D327, D328
#include "chain/lidar/scanner/mechanism.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "base/core/error.h"
#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr int kMaxOrder = 1 << 20;

[[noreturn]] void refuse_aim(std::int64_t pulse, double angle_rad, double limit_rad) {
  std::ostringstream message;
  if (std::isnan(angle_rad)) {  // the direction from a point to itself
    message << "scanner: pulse " << pulse << " has no direction: the pattern aims at the lidar itself";
    throw FormatError(message.str());
  }
  message << "scanner: pulse " << pulse << " aims " << in_degrees(angle_rad)
          << " degrees off the boresight; max_deflection_deg allows " << in_degrees(limit_rad)
          << " (raise it, or narrow the pattern)";
  throw FormatError(message.str());
}

constexpr double kTimeRounding_s = 1e-9;
/// e^-40 = 4e-18 is less than the rounding of an angle.
constexpr double kSettledExponent = 40;

}  // namespace

void check(const std::vector<EncoderHarmonic>& harmonics) {
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    const EncoderHarmonic& harmonic = harmonics[i];
    const std::string name = "encoder_harmonics/" + std::to_string(i);
    require(harmonic.axis == 1 || harmonic.axis == 2, {name, "axis"}, harmonic.axis, "1 or 2");
    require(harmonic.order >= 1 && harmonic.order <= kMaxOrder, {name, "order"}, harmonic.order,
            "in 1..1048576");
    require_finite({name, "amplitude_rad"}, harmonic.amplitude_rad);
    require_finite({name, "phase_deg"}, harmonic.phase_rad);
  }
}

TiltAngles encoder_error(const std::vector<EncoderHarmonic>& harmonics, const TiltAngles& angles) {
  TiltAngles error;
  for (const EncoderHarmonic& harmonic : harmonics) {
    const double angle = harmonic.axis == 1 ? angles.angle_1_rad : angles.angle_2_rad;
    double& sum = harmonic.axis == 1 ? error.angle_1_rad : error.angle_2_rad;
    sum += harmonic.amplitude_rad * portable::sin(harmonic.order * angle + harmonic.phase_rad);
  }
  return error;
}

void DeflectionLimit::require_within(const Direction<LidarFrame>& aim, std::int64_t pulse) const {
  const double off_boresight = portable::atan2(portable::hypot(aim.v.x(), aim.v.y()), aim.v.z());
  // The test is negated so that a NaN aim is refused too.
  if (!(off_boresight <= max_rad_)) refuse_aim(pulse, off_boresight, max_rad_);
}

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
