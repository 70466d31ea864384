// SPDX-License-Identifier: GPL-3.0-or-later
#include "errors/navigation_error.h"

#include <string>

#include "base/error.h"

namespace landfall {
namespace {

void require_finite(const char* key, const Eigen::Vector3d& v) {
  if (!v.allFinite()) throw UsageError(std::string("navigation_error: ") + key + " is not finite");
}

void require_finite(const char* key, const RollPitchYaw& rpy) {
  require_finite(key, Eigen::Vector3d(rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad));
}

}  // namespace

LinearNavigationError::LinearNavigationError(const NavigationErrorParameters& parameters)
    : parameters_(parameters) {
  require_finite("position_m", parameters.position_m.v);
  require_finite("velocity_mps", parameters.velocity_mps.v);
  require_finite("rpy_rad", parameters.rpy);
  require_finite("rpy_rate_radps", parameters.rpy_rate_radps);
}

Transform<DemFrame, BodyFrame> LinearNavigationError::estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                                double since_start_s) const {
  const Vector<DemFrame> p_err = parameters_.position_m + since_start_s * parameters_.velocity_mps;
  const auto R_err =
      rotation_from<BodyFrame, BodyFrame>(linear(parameters_.rpy, since_start_s, parameters_.rpy_rate_radps));
  return {truth.rotation * R_err, truth.position - p_err};
}

}  // namespace landfall
