// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/constant_velocity.h"

#include "geometry/parameter_check.h"

namespace landfall {
ConstantVelocity::ConstantVelocity(const ConstantVelocityParameters& parameters) : parameters_(parameters) {
  require_finite({"", "position_m"}, parameters.position_m.v);
  require_finite({"", "velocity_mps"}, parameters.velocity_mps.v);
  require_finite({"", "rpy_deg"}, parameters.rpy);
  require_finite({"", "rpy_rate_degps"}, parameters.rpy_rate_radps);
}

Pose ConstantVelocity::pose(double t_s) const {
  const RollPitchYaw rpy = linear(parameters_.rpy, t_s, parameters_.rpy_rate_radps);
  return {rotation_from<DemFrame, BodyFrame>(rpy), parameters_.position_m + t_s * parameters_.velocity_mps};
}

}  // namespace landfall
