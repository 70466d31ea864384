// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/geometry/map_position.h"
#include "chain/terrain/relief/site_mapping.h"
#include "chain/terrain/site_point.h"

class OGRSpatialReference;

namespace landfall {

/// The WKT of a site frame with its place on a map (chain/terrain/site_wkt.h): `center` in the units of the
/// map, `metres_per_unit` 0 where the frame's axes are not those of the map.
[[nodiscard]] std::string placed_on(const std::string& site_wkt, const OGRSpatialReference& map,
                                    const MapPoint& center, double metres_per_unit,
                                    const std::string& vertical);

/// Points of a site frame on its map; easting and northing only where its place names a projected one.
/// Rounded to 0.1 mm: the inverse of a projection is less accurate than the numbers. Positions are empty for
/// a frame that is not tied to a body, and where a projection has no value.
[[nodiscard]] std::vector<MapPosition> map_positions_of(const std::string& site_wkt,
                                                        const std::vector<SitePoint>& points);

}  // namespace landfall
