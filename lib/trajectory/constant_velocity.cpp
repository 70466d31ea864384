// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/constant_velocity.h"

#include <string>

#include "base/error.h"

namespace landfall {
namespace {

void require_finite(const char* key, const Eigen::Vector3d& v) {
  if (!v.allFinite()) throw UsageError(std::string("trajectory: ") + key + " is not finite");
}

void require_finite(const char* key, const RollPitchYaw& rpy) {
  require_finite(key, Eigen::Vector3d(rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad));
}

}  // namespace

ConstantVelocity::ConstantVelocity(const ConstantVelocityParameters& parameters) : parameters_(parameters) {
  require_finite("position_m", parameters.position_m.v);
  require_finite("velocity_mps", parameters.velocity_mps.v);
  require_finite("rpy", parameters.rpy);
  require_finite("rpy_rate", parameters.rpy_rate_radps);
}

Pose ConstantVelocity::pose(double t_s) const {
  const RollPitchYaw rpy = linear(parameters_.rpy, t_s, parameters_.rpy_rate_radps);
  return {rotation_from<DemFrame, BodyFrame>(rpy), parameters_.position_m + t_s * parameters_.velocity_mps};
}

}  // namespace landfall
