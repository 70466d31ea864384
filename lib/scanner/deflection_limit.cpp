// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/deflection_limit.h"

#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/portable_math.h"
#include "geometry/vector_check.h"

namespace landfall {
namespace {

[[noreturn]] void refuse_aim(std::int64_t pulse, double angle_rad, double limit_rad) {
  std::ostringstream message;
  if (std::isnan(angle_rad)) {  // the direction from a point to itself
    message << "scanner: pulse " << pulse << " has no direction: the pattern aims at the lidar itself";
    throw FormatError(message.str());
  }
  message << "scanner: pulse " << pulse << " aims " << in_degrees(angle_rad)
          << " degrees off the boresight; max_deflection_deg allows " << in_degrees(limit_rad)
          << " (raise it, or narrow the pattern)";
  throw FormatError(message.str());
}

}  // namespace

void DeflectionLimit::require_within(const Direction<LidarFrame>& aim, std::int64_t pulse) const {
  const double off_boresight = portable::atan2(portable::hypot(aim.v.x(), aim.v.y()), aim.v.z());
  // The test is negated so that a NaN aim is refused too.
  if (!(off_boresight <= max_rad_)) refuse_aim(pulse, off_boresight, max_rad_);
}

}  // namespace landfall
