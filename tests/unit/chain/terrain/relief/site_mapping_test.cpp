// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/site_mapping.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constants.h"

namespace landfall {
namespace {

TEST(GeoTransform, CentresAreHalfAPixelIn) {
  const GeoTransform north_up({100, 2, 0, 50, 0, -3});
  EXPECT_EQ(north_up.map_point({0, 0}).x, 101);
  EXPECT_EQ(north_up.map_point({0, 0}).y, 48.5);
  EXPECT_NEAR(north_up.pixel({105, 45.5}).col, 2, 1e-14);
  EXPECT_NEAR(north_up.pixel({105, 45.5}).row, 1, 1e-14);
}

TEST(GeoTransform, RotatedThereAndBack) {
  const GeoTransform rotated({10, 1.2, -0.5, 20, 0.7, 1.1});
  const MapPoint point = rotated.map_point({3.25, -1.5});
  EXPECT_NEAR(rotated.pixel(point).col, 3.25, 1e-13);
  EXPECT_NEAR(rotated.pixel(point).row, -1.5, 1e-13);
}

TEST(GeoTransform, KnowsWhatCannotBeInverted) {
  EXPECT_TRUE(GeoTransform({0, 1, 0, 0, 0, 1}).invertible());
  EXPECT_FALSE(GeoTransform({0, 0, 0, 0, 0, 1}).invertible());
  EXPECT_FALSE(GeoTransform({0, 1, 2, 0, 2, 4}).invertible());
  EXPECT_FALSE(GeoTransform({NAN, 1, 0, 0, 0, 1}).invertible());
  EXPECT_FALSE(GeoTransform({0, INFINITY, 0, 0, 0, 1}).invertible());
}

TEST(SiteMapping, LinearUnitsAndSouthUp) {
  const SiteMapping feet(GeoTransform({0, 10, 0, 0, 0, 20}), {7, 9}, 0.3048);  // south-up, 10 x 20 ft
  const PixelPosition p = feet.pixel({3.048, 6.096});
  EXPECT_NEAR(p.col, 8, 1e-13);
  EXPECT_NEAR(p.row, 10, 1e-13);
}

TEST(SiteMapping, WindowMovesTheOrigin) {
  const SiteMapping mapping = SiteMapping(GeoTransform({0, 1, 0, 0, 0, -1}), {70, 90}, 1).in_window({60, 85});
  EXPECT_EQ(mapping.pixel({2, 1}).col, 12);
  EXPECT_EQ(mapping.pixel({2, 1}).row, 4);
}

TEST(SiteMapping, PostingIsThatOfTheNearerNeighbour) {
  const SiteMapping feet(GeoTransform({0, 10, 0, 0, 0, -20}), {7, 9}, 0.3048);
  EXPECT_NEAR(feet.posting_m(), 3.048, 1e-12);
  const SiteMapping rotated(GeoTransform({10, 3, -8, 20, 4, 6}), {0, 0}, 1);  // cells of 5 m x 10 m
  EXPECT_NEAR(rotated.posting_m(), 5, 1e-12);
  // 1/100 degree at 60 deg of latitude on a sphere of 1000 km: half as long to the east as to the north.
  const OrthographicFrame frame({1e6, 0}, {1, kPi / 3});
  const SiteMapping degrees(GeoTransform({0, 0.01, 0, 0, 0, -0.01}), {5, 5}, frame, kPi / 180);
  EXPECT_NEAR(degrees.posting_m(), 1e6 * 0.01 * kPi / 180 * 0.5, 1e-4);
  const OrthographicFrame pole({1e6, 0}, {1, kPi / 2});
  const double none_m =
      SiteMapping(GeoTransform({0, 0.01, 0, 0, 0, -0.01}), {5, 5}, pole, kPi / 180).posting_m();
  EXPECT_FALSE(none_m > 1e-3 && std::isfinite(none_m)) << none_m;
}

// On a sphere an orthographic place at distance d along a meridian is the angle asin(d / R).
TEST(OrthographicFrame, PointIsTheInverseOfDifference) {
  for (const double flattening : {0.0, 1 / 298.257223563})
    for (const LonLat& center : {LonLat{0.3, 0.7}, LonLat{-2, -1.2}}) {
      const OrthographicFrame frame({6378137, flattening}, center);
      for (const SitePoint& point : {SitePoint{0, 0}, SitePoint{12.5, -70}, SitePoint{-30000, 45000}}) {
        const std::optional<SitePoint> back = frame.point(frame.difference(point));
        ASSERT_TRUE(back);
        EXPECT_NEAR(back->x_m, point.x_m, 1e-8);
        EXPECT_NEAR(back->y_m, point.y_m, 1e-8);
      }
    }
}

// Visible ground lies within 90 degrees of the centre, measured between the normals of the ellipsoid. There,
// and only there, difference() finds it again.
TEST(OrthographicFrame, HasNoPlaceBeyondTheHorizon) {
  for (const double flattening : {0.0, 1 / 298.257223563, 0.1})
    for (const double lat0 : {-kPi / 2, -1.2, 0.0, 0.7}) {
      const OrthographicFrame frame({1737400, flattening}, {0.4, lat0});
      for (double lon = -3.1; lon < 3.2; lon += 0.2)
        for (double lat = -1.55; lat < 1.6; lat += 0.1) {
          const double facing =
              std::sin(lat0) * std::sin(lat) + std::cos(lat0) * std::cos(lat) * std::cos(lon);
          const std::optional<SitePoint> point = frame.point({lon, lat - lat0});
          ASSERT_EQ(point.has_value(), facing > 0) << lon << ' ' << lat;
          if (!point || facing < 1e-3) continue;
          const LonLat back = frame.difference(*point);
          EXPECT_NEAR(std::remainder(back.lon_rad - lon, 2 * kPi) * std::cos(lat), 0, 1e-9);
          EXPECT_NEAR(back.lat_rad, lat - lat0, 1e-9);
        }
    }
  const OrthographicFrame equator({1737400, 0}, {0, 0});
  EXPECT_FALSE(equator.point({kPi / 2, 0}));
  EXPECT_FALSE(equator.point({kPi, 0}));
  EXPECT_TRUE(equator.point({kPi / 2 - 1e-9, 0}));
  EXPECT_TRUE(std::isnan(equator.point({kNan, 0})->x_m));
}

TEST(OrthographicFrame, SphereInClosedForm) {
  const double radius_m = 500;
  const OrthographicFrame equator({radius_m, 0}, {1, 0});
  for (const double d : {-300.0, -1.0, 0.0, 0.001, 50.0, 499.0}) {
    EXPECT_NEAR(equator.difference({d, 0}).lon_rad, std::asin(d / radius_m), 1e-13);
    EXPECT_NEAR(equator.difference({d, 0}).lat_rad, 0, 1e-15);
    EXPECT_NEAR(equator.difference({0, d}).lat_rad, std::asin(d / radius_m), 1e-13);
  }
  // Off the equator, east of the centre: tan(dlon) = sin c / (cos lat0 cos c), Snyder (1987) 20-15.
  const OrthographicFrame tilted({radius_m, 0}, {0, kPi / 3});
  const double c = std::asin(100 / radius_m);
  EXPECT_NEAR(tilted.difference({100, 0}).lon_rad, std::atan2(std::sin(c), 0.5 * std::cos(c)), 1e-14);
  EXPECT_TRUE(std::isnan(equator.difference({501, 0}).lat_rad));
}

// EPSG guidance note 7-2, method 9840: forward formulas for the ellipsoid, here undone.
TEST(OrthographicFrame, EllipsoidUndoesTheForwardFormulas) {
  const Ellipsoid mars{3396190, 1 / 169.894447223612};
  const double e2 = mars.flattening * (2 - mars.flattening);
  const auto normal = [&](double lat) {
    return mars.semi_major_m / std::sqrt(1 - e2 * std::pow(std::sin(lat), 2));
  };
  for (const double lat0 : {-1.2, -0.08, 0.0, 0.7, 1.5}) {
    const OrthographicFrame frame(mars, {2.4, lat0});
    for (const double dlat : {-0.02, 0.0, 0.03})
      for (const double dlon : {-0.05, 0.0, 0.01}) {
        const double lat = lat0 + dlat;
        const double east_m = normal(lat) * std::cos(lat) * std::sin(dlon);
        const double north_m =
            normal(lat) * (std::sin(lat) * std::cos(lat0) - std::cos(lat) * std::sin(lat0) * std::cos(dlon)) +
            e2 * (normal(lat0) * std::sin(lat0) - normal(lat) * std::sin(lat)) * std::cos(lat0);
        const LonLat back = frame.difference({east_m, north_m});
        EXPECT_NEAR(back.lon_rad, dlon, 1e-13) << lat0;
        EXPECT_NEAR(back.lat_rad, dlat, 1e-13) << lat0;
      }
  }
}

TEST(OrthographicFrame, PoleIsAPlace) {
  const OrthographicFrame pole({1000, 0}, {0, kPi / 2});
  EXPECT_NEAR(pole.difference({0, -500}).lat_rad, -std::asin(0.5), 1e-14);
  EXPECT_NEAR(pole.difference({0, -500}).lon_rad, 0, 1e-14);
  EXPECT_NEAR(pole.difference({500, 0}).lon_rad, kPi / 2, 1e-14);
}

}  // namespace
}  // namespace landfall
