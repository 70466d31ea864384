// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D335
#include "control.h"

#include <algorithm>
#include <cmath>

namespace lander {

const Controls& Actuators::follow(const Controls& command, double period_s) {
  const double thrust = std::clamp(command.thrust_n, 0.0, limits_.thrust_n);
  const Vector3d torque = command.torque_nm.cwiseMax(-limits_.torque_nm).cwiseMin(limits_.torque_nm);
  now_.thrust_n += (1 - std::exp(-period_s / limits_.thrust_lag_s)) * (thrust - now_.thrust_n);
  now_.torque_nm += (1 - std::exp(-period_s / limits_.torque_lag_s)) * (torque - now_.torque_nm);
  return now_;
}

double Controller::braking(const BusState& estimate) const {
  double rate = gains_.descent_mps, feed_forward = 0;
  if (site_m_) {
    const double height = std::max(estimate.position_m.z() - site_m_->z() - design_.standing_m(), 0.0);
    const double last = gains_.touchdown_mps;
    rate = std::min(rate, std::sqrt(last * last + 2 * gains_.braking_mps2 * height));
    if (rate < gains_.descent_mps && rate > last) feed_forward = gains_.braking_mps2;
  }
  return feed_forward + gains_.descent_gain_per_s * (-rate - estimate.velocity_mps.z());
}

Vector3d Controller::guidance(const BusState& estimate) const {
  const double up = design_.gravity_mps2 + braking(estimate);
  const Vector3d away = estimate.position_m - site_m_.value_or(Vector3d::Zero());
  Vector3d force = -gains_.position_gain_per_s2 * away - gains_.velocity_gain_per_s * estimate.velocity_mps;
  force.z() = std::max(up, 0.1 * design_.gravity_mps2);
  const double sideways = force.head<2>().norm(), limit = std::tan(gains_.tilt_limit_rad) * force.z();
  if (sideways > limit) force.head<2>() *= limit / sideways;
  return force;
}

Controls Controller::command(const BusState& estimate) const {
  const Vector3d force = guidance(estimate);
  const Quaterniond wanted = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), force);
  const Vector3d error = rotation_vector(wanted.conjugate() * estimate.attitude);
  const double rate = gains_.attitude_frequency_radps;
  const Vector3d acceleration =
      -rate * rate * error - 2 * gains_.attitude_damping * rate * estimate.rate_radps;
  return {design_.total_kg() * force.norm(), design_.bus_inertia_kgm2.cwiseProduct(acceleration)};
}

}  // namespace lander
