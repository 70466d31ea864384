// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "base/core/error.h"
#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/point_frame.h"

namespace landfall {

MapPoint rounded_center(const MapPoint& low, const MapPoint& high, double metres_per_unit) {
  const double steps = std::pow(10, -std::floor(-std::log10(metres_per_unit) + 1e-9));  // per unit
  const auto rounded = [&](double a, double b) {
    return std::round((a / 2 + b / 2) * steps) / steps + 0.0;  // -0 becomes 0
  };
  return {rounded(low.x, high.x), rounded(low.y, high.y)};
}

PointFrame local_point_frame(const PointFrameRequest& request) {
  if (request.stated && request.stated->is_angle)
    throw FormatError(
        request.name +
        ": x and y are longitudes and latitudes by their names, and it has no CRS: give that of "
        "their body, for example --crs EPSG:4326 (Earth) or --crs IAU_2015:30100 (Moon)");
  PointFrame frame;
  frame.center = request.center.value_or(rounded_center(request.low, request.high, 1));
  frame.metres_per_height = request.vertical_scale.value_or(1);
  frame.crs_wkt = with_place(
      kLocalSiteCrsWkt,
      {.center = {frame.center.x, frame.center.y, 0}, .metres_per_unit = 1, .vertical = {}, .map_wkt = {}});
  frame.assumed.emplace_back(request.stated
                                 ? "has no CRS: its site is not tied to a map (--crs gives one)"
                                 : "has no CRS: its coordinates are taken as metres (--crs gives one)");
  return frame;
}

}  // namespace landfall
