// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "geometry/frames.h"

namespace landfall {

/// How far off +z_L a mechanism can point.
class DeflectionLimit {
 public:
  /// The mechanism has already checked its limit `max_rad`.
  explicit DeflectionLimit(double max_rad) : max_rad_(max_rad) {}

  /// Throws FormatError, naming pulse and angle, for an aim beyond the limit, or one that is NaN.
  void require_within(const Direction<LidarFrame>& aim, std::int64_t pulse) const;

 private:
  double max_rad_;
};

}  // namespace landfall
