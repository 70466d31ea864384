// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geometry/map_position.h"
#include "terrain/site_point.h"

class OGRSpatialReference;

namespace landfall {

/// The WKT of a site frame with the CRS of its map as a remark, from which map_positions_of() takes easting
/// and northing. Unchanged for a map that is not projected.
[[nodiscard]] std::string with_map(const std::string& site_wkt, const OGRSpatialReference& map);

/// Points of a site frame on its map; easting and northing only with the remark of with_map(). Rounded to
/// 0.1 mm: the inverse of a projection is less accurate than the numbers. Positions are empty for a frame
/// that is not tied to a body, and where a projection has no value.
[[nodiscard]] std::vector<MapPosition> map_positions_of(const std::string& site_wkt,
                                                        const std::vector<SitePoint>& points);

}  // namespace landfall
