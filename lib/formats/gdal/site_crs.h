// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "chain/terrain/relief/site_mapping.h"
#include "formats/gdal/map_projection.h"

namespace landfall {

/// WKT of a format of GDAL on one line; empty where PROJ refuses.
[[nodiscard]] std::string to_wkt(const OGRSpatialReference& crs, const char* format = "FORMAT=WKT2_2018");

/// The same projection in metres with its false origin moved to the site centre; the local CRS where the
/// projection has no false origin or PROJ refuses. `center` in the units of `crs`.
[[nodiscard]] std::string shifted_wkt(const OGRSpatialReference& crs,
                                      const std::optional<MapProjection>& projection, const MapPoint& center);

/// Longitude and latitude in the units of `geographic`, the longitude within half a turn.
[[nodiscard]] MapPoint lon_lat_of(const OGRSpatialReference& geographic, const LonLat& lon_lat);

/// The CRS of the orthographic frame around a longitude and latitude.
[[nodiscard]] std::string orthographic_wkt(const OGRSpatialReference& geographic, const MapPoint& center);

}  // namespace landfall
