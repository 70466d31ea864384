// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

namespace landfall {

/// A point of a site on the map that the site was taken from. Empty are all of a site without a CRS, and
/// easting and northing of a map of longitudes and latitudes.
struct MapPosition {
  std::optional<double> easting_m;  ///< of the map, in metres whatever its unit is
  std::optional<double> northing_m;
  std::optional<double> latitude_deg;   ///< on the ellipsoid of the map's body, north is positive
  std::optional<double> longitude_deg;  ///< in [-180, 180], east is positive
  friend bool operator==(const MapPosition&, const MapPosition&) = default;
};

/// How files and tables name a map coordinate.
struct MapCoordinate {
  const char* column;  ///< of a table in a file
  const char* units;
  const char* key;  ///< in JSON
  const char* description;
  std::optional<double> MapPosition::*value;
};

/// In the order of files and tables.
inline constexpr std::array<MapCoordinate, 4> kMapCoordinates = {
    {{"easting", "m", "easting_m", "easting on the map of the site", &MapPosition::easting_m},
     {"northing", "m", "northing_m", "northing on the map of the site", &MapPosition::northing_m},
     {"latitude", "degrees_north", "latitude_deg", "latitude on the body of the map",
      &MapPosition::latitude_deg},
     {"longitude", "degrees_east", "longitude_deg", "longitude on the body of the map",
      &MapPosition::longitude_deg}}};

}  // namespace landfall
