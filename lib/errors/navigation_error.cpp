// SPDX-License-Identifier: GPL-3.0-or-later
#include "errors/navigation_error.h"

#include "geometry/parameter_check.h"

namespace landfall {
LinearNavigationError::LinearNavigationError(const NavigationErrorParameters& parameters)
    : parameters_(parameters) {
  require_finite({"navigation_error", "position_m"}, parameters.position_m.v);
  require_finite({"navigation_error", "velocity_mps"}, parameters.velocity_mps.v);
  require_finite({"navigation_error", "rpy_rad"}, parameters.rpy);
  require_finite({"navigation_error", "rpy_rate_radps"}, parameters.rpy_rate_radps);
}

Transform<DemFrame, BodyFrame> LinearNavigationError::estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                                double since_start_s) const {
  const Vector<DemFrame> p_err = parameters_.position_m + since_start_s * parameters_.velocity_mps;
  const auto R_err =
      rotation_from<BodyFrame, BodyFrame>(linear(parameters_.rpy, since_start_s, parameters_.rpy_rate_radps));
  return {truth.rotation * R_err, truth.position - p_err};
}

}  // namespace landfall
