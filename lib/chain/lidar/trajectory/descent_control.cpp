// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/descent_control.h"

#include <algorithm>
#include <cmath>

#include "base/geometry/rotation_vector.h"
#include "base/geometry/vector_check.h"

namespace landfall {
namespace {

double switched(double signal, double deadband, double torque) {
  if (std::abs(signal) <= deadband) return 0;
  return signal > 0 ? -torque : torque;
}

}  // namespace

Vector<BodyFrame> thrust_of(const DescentThrust& thrust, double weight_per_mass_mps2, double mass_kg,
                            const RigidBodyState& state) {
  const double cos_tilt = state.attitude.toRotationMatrix()(2, 2);
  if (!(cos_tilt > 0)) return {};
  const double correction = thrust.gain_per_s * (-thrust.descent_rate_mps - state.velocity_mps.v.z());
  const double wanted = mass_kg * (weight_per_mass_mps2 + correction) / cos_tilt;
  return {{0, 0, std::clamp(wanted, 0.0, thrust.max_n)}};
}

Vector<BodyFrame> torque_of(const AttitudeControl& control, const RigidBodyState& state) {
  const Eigen::Quaterniond commanded(rotation_matrix(control.command));
  const Eigen::Vector3d signal =
      rotation_vector(commanded.conjugate() * state.attitude) + control.rate_gain_s * state.rate_radps.v;
  Vector<BodyFrame> torque;
  for (int i = 0; i < 3; ++i) torque.v[i] = switched(signal[i], control.deadband_rad, control.torque_nm[i]);
  return torque;
}

void require_valid(const DescentThrust& thrust, double control_period_s) {
  require_finite({"thrust", "descent_rate_mps"}, thrust.descent_rate_mps);
  require_not_negative({"thrust", "max_n"}, thrust.max_n);
  require_not_negative({"thrust", "gain_per_s"}, thrust.gain_per_s);
  require(thrust.gain_per_s * control_period_s <= 1, {"thrust", "gain_per_s"}, thrust.gain_per_s,
          "at most 1 / control_period_s: held thrust would overshoot");
}

void require_valid(const AttitudeControl& control) {
  const std::string owner = "attitude_control";
  require_finite({owner, "command_rpy_deg"}, control.command);
  require_angle(std::isfinite(control.deadband_rad) && control.deadband_rad >= 0, {owner, "deadband_deg"},
                control.deadband_rad, "finite and >= 0");
  require_not_negative({owner, "rate_gain_s"}, control.rate_gain_s);
  for (int i = 0; i < 3; ++i)
    require_not_negative({owner, "torque_nm/" + std::to_string(i)}, control.torque_nm[i]);
}

}  // namespace landfall
