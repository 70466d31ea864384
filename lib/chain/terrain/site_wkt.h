// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>

namespace landfall {

/// The origin of a site frame on the map that the site was taken from. A terrain without a site has the
/// default: no map, centre 0, 0, 0.
struct MapPlace {
  /// Position of the frame's origin: x and y in units of the map, the height in metres on `vertical`.
  std::array<double, 3> center{};
  /// Metres per unit of the map where the frame's axes are those of the map; 0 for the orthographic frame of
  /// longitudes and latitudes or of a map whose scale at the site is not 1.
  double metres_per_unit = 1;
  std::string vertical;  ///< name of the vertical datum; empty: not known
  std::string map_wkt;   ///< horizontal CRS of the map; empty: none
  friend bool operator==(const MapPlace&, const MapPlace&) = default;
};

/// The default, with the map that a frame of version 0.2.0 names.
[[nodiscard]] MapPlace unplaced(const std::string& site_wkt);

/// All digits of a coordinate that read back as the same number, without an exponent: 500000, not 5e+05.
[[nodiscard]] std::string coordinate_text(double number);

/// The WKT of a site frame with its place as a remark (WKT2, ISO 19162), the one carrier of the place in
/// files and in memory: "center: X, Y, Z; unit: M; heights: NAME; map: WKT". In it ' stands for " and ` for
/// ', because readers that do not know doubled quotes must be able to skip it. Replaces a remark of before;
/// a text that is not WKT is returned as it is.
[[nodiscard]] std::string with_place(const std::string& site_wkt, const MapPlace& place);

/// The place that a remark of with_place() gives. None without one, and for the remark of version 0.2.0,
/// which has only the map.
[[nodiscard]] std::optional<MapPlace> place_of(const std::string& site_wkt);

/// The same frame with its origin higher by `height_m`; unchanged without a place.
[[nodiscard]] std::string raised(const std::string& site_wkt, double height_m);

/// The WKT of the site's map from the remark of either version; empty: none.
[[nodiscard]] std::string map_wkt_of(const std::string& site_wkt);

/// The WKT of the site frame alone.
[[nodiscard]] std::string without_place(const std::string& site_wkt);

}  // namespace landfall
