// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/exports/point_reader.h"

namespace landfall {

/// A map in feet of half a metre, whose axes are the site's.
inline MapFrame planar_map() {
  return {.crs_name = "map",
          .crs_wkt = "PROJCS[\"map\"]",
          .unit = "ft",
          .center = {500000, 5400000.5},
          .metres_per_unit = 0.5,
          .center_height = 300};
}

/// Longitude and latitude; a metre is 1e-5 degrees in x and 2e-5 in y.
inline MapFrame geographic_map() {
  MapFrame map{.crs_name = "globe", .crs_wkt = "GEOGCS[\"globe\"]", .is_geographic = true, .unit = "degree"};
  map.map_point = [](const SitePoint& at) { return MapPoint{9 + 1e-5 * at.x_m, 48 + 2e-5 * at.y_m}; };
  map.center = {9, 48};
  map.metres_per_unit = 111000;
  return map;
}

}  // namespace landfall
