// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/map_projection.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <numbers>
#include <string>

#include "constants.h"

namespace landfall {
namespace {

struct Map {
  const char* crs;          ///< as GDAL's SetFromUserInput takes it
  double lon_deg, lat_deg;  ///< a place that it shows
};

std::string shown(const testing::TestParamInfo<Map>& info) { return "map_" + std::to_string(info.index); }

OGRSpatialReference crs_of_map(const Map& map) {
  OGRSpatialReference crs;
  EXPECT_EQ(crs.SetFromUserInput(map.crs), OGRERR_NONE) << map.crs;
  return crs;
}

class MapProjectionOf : public testing::TestWithParam<Map> {};

TEST_P(MapProjectionOf, EqualsGdalsTransformation) {
  const OGRSpatialReference crs = crs_of_map(GetParam());
  const auto found = MapProjection::of(crs);
  const auto expected = MapProjection::by_gdal(crs);
  ASSERT_TRUE(found && expected);
  const double unit_m = crs.GetLinearUnits();
  for (const double east : {-0.3, 0.0, 0.001, 0.2})
    for (const double north : {-0.2, 0.0, 0.001, 0.3}) {
      const LonLat at{(GetParam().lon_deg + east) * kDegree, (GetParam().lat_deg + north) * kDegree};
      const MapPoint point = found->map_point(at);
      const MapPoint expected_point = expected->map_point(at);
      EXPECT_LT(std::hypot(point.x - expected_point.x, point.y - expected_point.y) * unit_m, 1e-7);
      const LonLat back = found->lon_lat(point);
      const LonLat expected_back = expected->lon_lat(point);
      EXPECT_NEAR(std::remainder(back.lon_rad - expected_back.lon_rad, 2 * std::numbers::pi), 0, 1e-12);
      EXPECT_NEAR(back.lat_rad, expected_back.lat_rad, 1e-12);
    }
}

TEST_P(MapProjectionOf, IsNaNWhereGdalIsNaN) {
  const OGRSpatialReference crs = crs_of_map(GetParam());
  const auto found = MapProjection::of(crs);
  const auto expected = MapProjection::by_gdal(crs);
  ASSERT_TRUE(found && expected);
  const LonLat opposite{(GetParam().lon_deg + 180) * kDegree, -GetParam().lat_deg * kDegree};
  EXPECT_EQ(std::isnan(found->map_point(opposite).x), std::isnan(expected->map_point(opposite).x));
  const MapPoint far{3e8, -3e8};
  EXPECT_EQ(std::isnan(found->lon_lat(far).lon_rad), std::isnan(expected->lon_lat(far).lon_rad));
}

INSTANTIATE_TEST_SUITE_P(
    Crs, MapProjectionOf,
    testing::Values(
        Map{"+proj=stere +lat_0=90 +lon_0=0 +R=1737400 +units=m", -46.43, 87.556},
        Map{"+proj=stere +lat_0=-90 +lat_ts=-70 +lon_0=30 +a=3396190 +b=3376200", 100, -80},
        Map{"+proj=ortho +lat_0=-32.53 +lon_0=-27.29 +R=1561500", -27.29, -32.53},
        Map{"+proj=eqc +lat_ts=18.4 +lon_0=180 +R=3396190", 77.5, 18.4},
        Map{"+proj=sinu +lon_0=10 +R=3396190", 15, 30}, Map{"+proj=aea +lat_1=20 +lat_2=50 +R=252100", 3, 35},
        Map{"+proj=tmerc +lat_0=4.5 +lon_0=137.4 +k=0.9996 +x_0=1000 +a=3396190 +rf=169.89 +units=km", 137.4,
            4.5},
        Map{"+proj=omerc +lat_0=10 +lonc=20 +alpha=30 +gamma=25 +k=1 +R=1737400", 20, 10},
        Map{"EPSG:32633", 15.3, 47.1}, Map{"EPSG:32733", 15.3, -23.1}, Map{"EPSG:3857", 8, 47},
        Map{"EPSG:2229", -118, 34},    // US survey feet
        Map{"EPSG:5514", 15, 50},      // axes to the south and west, another prime meridian
        Map{"EPSG:2193", 173, -41},    // New Zealand
        Map{"EPSG:27572", 2.5, 46.8},  // from Paris, in grads
        Map{"EPSG:31370", 4.4, 50.8}, Map{"EPSG:2056", 7.4, 46.9}, Map{"ESRI:54030", 10, 20}),  // Robinson
    shown);

TEST(MapProjection, IsNoneForALocalCrs) {
  OGRSpatialReference local;
  local.SetLocalCS("somewhere");
  EXPECT_FALSE(MapProjection::of(local));
  EXPECT_FALSE(MapProjection::by_gdal(local));
}

}  // namespace
}  // namespace landfall
