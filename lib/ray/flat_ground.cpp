// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/flat_ground.h"

#include <limits>

namespace landfall {

void FlatGround::first_hits(std::span<const Ray> rays, std::span<double> ranges) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // A level ray gives an infinite range, or NaN if its origin lies in the plane.
    const double range = (elevation_m_ - rays[i].origin.v.z()) / rays[i].direction.v.z();
    const bool hits = range >= 0 && range <= std::numeric_limits<double>::max();
    ranges[i] = hits ? range : std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace landfall
