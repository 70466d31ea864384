// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/parameter_check.h"
#include "geometry/rotation.h"

namespace landfall {

/// Each component must be finite; the message names its index.
inline void require_finite(const ParameterName& name, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) require_finite({name.owner, name.key + "/" + std::to_string(i)}, v[i]);
}

inline void require_finite(const ParameterName& name, const RollPitchYaw& rpy) {
  require_finite(name, Eigen::Vector3d(rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad));
}

}  // namespace landfall
