// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chain/terrain/relief/geodetic_extent.h"
#include "chain/terrain/relief/site_mapping.h"
#include "chain/terrain/site_point.h"

namespace landfall {

/// The CRS of points. The first that is there counts: `option`, `wkt`, `keys`; none: no CRS.
struct PointCrs {
  std::string option;  ///< a definition that a user gives: EPSG:32632, +proj=..., WKT
  std::string wkt;     ///< of the file
  /// GeoTIFF's keys of the file: directory, numbers, texts.
  std::vector<std::uint16_t> key_directory;
  std::vector<double> key_numbers;
  std::string key_texts;

  [[nodiscard]] bool is_given() const { return !option.empty() || !wkt.empty() || !key_directory.empty(); }
};

/// The unit that a file itself states for x and y.
struct StatedMapUnit {
  bool is_angle = false;           ///< degrees, or without a `text` a unit that only the CRS gives
  std::array<double, 2> metres{};  ///< of a length: metres per unit of x and of y
  std::string text{};              ///< of a length, as the file spells it
};

struct PointFrameRequest {
  std::string name;  ///< begins messages
  PointCrs crs;
  MapPoint low, high;              ///< the extent of the points, units of the CRS
  std::optional<MapPoint> center;  ///< none: the middle of the extent, rounded
  std::optional<double> vertical_scale{};
  std::optional<StatedMapUnit> stated{};  ///< none: the file states no unit
  /// Their extent where they lie across the seam of their CRS (GeodeticExtentSearch).
  std::optional<GeodeticExtent> across_seam{};
  /// Whether body-fixed x, y, z of a geocentric CRS are longitude, latitude (degrees) and height (metres)
  /// now.
  bool is_geodetic = false;
};

/// Body-fixed x, y, z of a geocentric CRS.
struct BodyFixed {
  Ellipsoid body;
  double metres_per_unit = 1;
};

/// The frame of a site for points of a map, as SiteFrame is for a raster.
struct PointFrame {
  MapPoint center;             ///< of the site, units of the CRS
  double metres_per_unit = 1;  ///< of the map; 0 where `site` is set
  double metres_per_height = 1;
  /// The place of a point of the map: none beyond the horizon of the site, NaN outside the map's projection.
  /// Not set: (point - center) metres_per_unit.
  std::function<std::optional<SitePoint>(const MapPoint&)> site{};
  /// Set where the points may lie across the seam of their CRS: repeat the request with their extent.
  std::function<LonLat(const MapPoint&)> lon_lat{};
  /// Set for a geocentric CRS, and nothing else: repeat the request with geodetic points.
  std::optional<BodyFixed> body_fixed{};
  bool one_thread = false;             ///< `site` and `lon_lat` must not be called from several threads
  std::string crs_wkt;                 ///< of the site
  std::string crs_name;                ///< of the points
  std::vector<std::string> assumed{};  ///< sentences without the file's name
};

/// The centre of an extent for coordinates whose unit has this many metres: rounded to the power of ten of
/// the unit that is at most a metre (1 m, 1 ft, 0.000001 degree).
[[nodiscard]] MapPoint rounded_center(const MapPoint& low, const MapPoint& high, double metres_per_unit);

/// The frame of points without a CRS: metres. Throws FormatError for longitudes and latitudes.
[[nodiscard]] PointFrame local_point_frame(const PointFrameRequest& request);

}  // namespace landfall
