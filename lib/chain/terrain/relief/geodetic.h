// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "chain/terrain/relief/site_mapping.h"

namespace landfall {

/// A point by its longitude, geodetic latitude and height above an ellipsoid.
struct Geodetic {
  LonLat lon_lat;
  double height_m = 0;
};

/// The point of body-fixed coordinates: origin at the ellipsoid's centre, z through its north pole, x through
/// the meridian of longitude 0. Within rounding for points outside half of the semi-minor axis, for
/// flattenings up to a third; NaN for the centre itself, which has no place.
[[nodiscard]] Geodetic geodetic_of(const Ellipsoid& body, const Eigen::Vector3d& p_body_m);

}  // namespace landfall
