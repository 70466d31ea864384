// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "base/text/number_text.h"
#include "chain/terrain/relief/site_mapping.h"
#include "chain/terrain/site_point.h"

namespace landfall {

/// "m" or "ft", else "0.01 m".
[[nodiscard]] inline std::string length_unit_name(double metres) {
  if (metres == 1) return "m";
  return std::abs(metres - 0.3048) < 1e-6 ? "ft" : number_text(metres) + " m";
}

/// The map that a site was taken from, as the frame of coordinates.
struct MapFrame {
  std::string crs_name;
  std::string crs_wkt;         ///< WKT 1 where that can express the CRS, as LAS needs it, else WKT 2
  bool is_geographic = false;  ///< x is longitude, y latitude
  std::string unit = "m";      ///< of x and y: m, ft, 0.5 m, degree, or the angle's name
  MapPoint center = {};        ///< of the site
  double metres_per_unit = 1;  ///< of x and y; of a geographic one along the equator
  double center_height = 0;    ///< of the site
  double metres_per_height = 1;
  /// The coordinates of a point of the site; not set: center + point / metres_per_unit. One call at a time.
  std::function<MapPoint(const SitePoint&)> map_point{};

  [[nodiscard]] MapPoint at(const SitePoint& point) const {
    if (map_point) return map_point(point);
    return {center.x + point.x_m / metres_per_unit, center.y + point.y_m / metres_per_unit};
  }
  [[nodiscard]] double height_at(double z_m) const { return center_height + z_m / metres_per_height; }
};

/// The map that the place of a site names (chain/terrain/site_wkt.h); of a file of an older version, which
/// names none, longitude and latitude for an orthographic site frame, else the site frame itself. Coordinates
/// are exact to some 1e-9 m. None for a frame that is not tied to a body. Throws IoError if the plugin is
/// missing.
[[nodiscard]] std::optional<MapFrame> map_frame(const std::string& site_wkt);

/// The plugin's side of map_frame().
[[nodiscard]] std::optional<MapFrame> map_frame_of(const std::string& site_wkt);

}  // namespace landfall
