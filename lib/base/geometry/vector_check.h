// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numbers>

#include "base/geometry/rotation.h"
#include "base/text/parameter_check.h"

namespace landfall {

/// Degrees for messages, rounded to a billionth of a degree, so that pi/6 gives 30.
[[nodiscard]] inline double in_degrees(double angle_rad) {
  return std::round(angle_rad * (180 / std::numbers::pi) * 1e9) / 1e9;
}

/// As require(), for an angle whose key is in degrees; the message and `bound` are in degrees, too.
inline void require_angle(bool holds, const ParameterName& name_deg, double angle_rad, const char* bound) {
  require(holds, name_deg, in_degrees(angle_rad), bound);
}

/// Each component must be finite; the message names its index.
inline void require_finite(const ParameterName& name, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) require_finite({name.owner, name.key + "/" + std::to_string(i)}, v[i]);
}

inline void require_finite(const ParameterName& name, const RollPitchYaw& rpy) {
  require_finite(name, Eigen::Vector3d(rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad));
}

}  // namespace landfall
