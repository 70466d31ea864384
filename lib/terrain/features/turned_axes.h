// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/portable_math.h"
#include "terrain/features/feature_role.h"

namespace landfall {

/// The axes (u, v) of an object whose u axis is turned counter-clockwise from +x by a yaw.
class TurnedAxes {
 public:
  explicit TurnedAxes(double yaw_rad) : cos_(portable::cos(yaw_rad)), sin_(portable::sin(yaw_rad)) {}

  /// A point in the object's axes, (u, v).
  [[nodiscard]] Offset own(const Offset& offset) const {
    return {cos_ * offset.x_m + sin_ * offset.y_m, cos_ * offset.y_m - sin_ * offset.x_m};
  }

 private:
  double cos_;
  double sin_;
};

}  // namespace landfall
