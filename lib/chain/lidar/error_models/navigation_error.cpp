// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D84
#include "chain/lidar/error_models/navigation_error.h"

#include "base/geometry/vector_check.h"

namespace landfall {

Transform<DemFrame, BodyFrame> estimated(const Transform<DemFrame, BodyFrame>& truth,
                                         const PoseError& error) {
  return {truth.rotation * error.R_err, truth.position - error.p_err};
}

LinearNavigationError::LinearNavigationError(const NavigationErrorParameters& parameters)
    : parameters_(parameters) {
  require_finite({"", "position_m"}, parameters.position_m.v);
  require_finite({"", "velocity_mps"}, parameters.velocity_mps.v);
  require_finite({"", "rpy_rad"}, parameters.rpy);
  require_finite({"", "rpy_rate_radps"}, parameters.rpy_rate_radps);
}

PoseError LinearNavigationError::error(double since_start_s) const {
  return {parameters_.position_m + since_start_s * parameters_.velocity_mps,
          rotation_from<BodyFrame, BodyFrame>(
              linear(parameters_.rpy, since_start_s, parameters_.rpy_rate_radps))};
}

Transform<DemFrame, BodyFrame> LinearNavigationError::estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                                double since_start_s) const {
  return landfall::estimated(truth, error(since_start_s));
}

}  // namespace landfall
