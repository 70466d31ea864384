// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geometry/frames.h"
#include "terrain/surface.h"

namespace landfall {

/// tan(theta), theta the angle between a beam and the normal of the triangle that it hits, at most 89 deg
/// because the slope of a cliff seen edge-on is unbounded. `hit` lies on `ground`. 0 in or on the edge of a
/// hole, where the triangle is unknown. NaN for a hit that is NaN.
[[nodiscard]] double tan_incidence(const TerrainSurface& ground, const Point<DemFrame>& hit,
                                   const Direction<DemFrame>& beam);

}  // namespace landfall
