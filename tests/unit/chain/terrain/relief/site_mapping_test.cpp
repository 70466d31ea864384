// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "chain/terrain/relief/geodetic.h"
#include "chain/terrain/relief/geodetic_extent.h"
#include "chain/terrain/relief/site_fit.h"
#include "chain/terrain/relief/site_mapping.h"
#include "constants.h"
#include "refusal.h"

namespace landfall {
namespace {

using enum Interpolation;

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

/// 21 x 31 pixels of 2 m, the site around the pixel (`col`, 15).
struct Raster {
  explicit Raster(double col) : mapping(GeoTransform({0, 2, 0, 62, 0, -2}), {col, 15}, 1) {}
  [[nodiscard]] SiteSize fit(Interpolation method, const SiteRequest& request) const {
    return fit_site({mapping, {31, 21}, 2}, method, request, "a.tif");
  }
  SiteMapping mapping;
};

// The nearest pixel reaches half a pixel beyond the outermost centres, the others end there.
TEST(FitSite, IsTheLargestSquareAroundTheCentre) {
  EXPECT_EQ(Raster(10).fit(bilinear, {}), (SiteSize{20, 2}));
  EXPECT_EQ(Raster(10).fit(bicubic, {{}, 1}), (SiteSize{20, 1}));
  EXPECT_EQ(Raster(10).fit(nearest, {{}, 1}), (SiteSize{21, 1}));
  EXPECT_EQ(Raster(10).fit(bilinear, {{}, 3}), (SiteSize{18, 3}));
  EXPECT_EQ(Raster(4).fit(bilinear, {}), (SiteSize{8, 2}));
}

TEST(FitSite, ResolutionDividesAGivenHalfWidth) {
  EXPECT_EQ(Raster(10).fit(bilinear, {10, {}}), (SiteSize{10, 2}));
  EXPECT_EQ(Raster(10).fit(bilinear, {9, {}}), (SiteSize{9, 1.8}));
  EXPECT_EQ(Raster(10).fit(bilinear, {1, {}}), (SiteSize{1, 1}));
  EXPECT_EQ(Raster(10).fit(bilinear, {7, 0.5}), (SiteSize{7, 0.5}));
  EXPECT_EQ(Raster(10).fit(bilinear, {1000, 10}), (SiteSize{1000, 10}));  // refused where it is imported
}

TEST(FitSite, SaysWhatIsMissing) {
  const auto refusal = [](double col, const SiteRequest& request) {
    return kind_and_refusal([&] { return Raster(col).fit(bilinear, request); });
  };
  EXPECT_THAT(refusal(10, {{}, 0.001}), ::testing::AllOf(::testing::StartsWith("usage: a.tif: "),
                                                         ::testing::HasSubstr("half_width_m")));
  EXPECT_EQ(refusal(10, {{}, 20.0 / 4095}), "accepted");
  EXPECT_THAT(refusal(0, {}), ::testing::AllOf(::testing::StartsWith("format: a.tif: "),
                                               ::testing::HasSubstr("another center")));
  EXPECT_THAT(refusal(40, {}), ::testing::StartsWith("format: a.tif: "));
}

/// Helmert's formulas, the inverse of geodetic_of().
Eigen::Vector3d body_fixed(const Ellipsoid& body, const Geodetic& at) {
  const double e2 = body.flattening * (2 - body.flattening);
  const double s = std::sin(at.lon_lat.lat_rad);
  const double normal_m = body.semi_major_m / std::sqrt(1 - e2 * s * s);
  const double axis_m = (normal_m + at.height_m) * std::cos(at.lon_lat.lat_rad);
  return {axis_m * std::cos(at.lon_lat.lon_rad), axis_m * std::sin(at.lon_lat.lon_rad),
          (normal_m * (1 - e2) + at.height_m) * s};
}

TEST(Geodetic, UndoesHelmertsFormulas) {
  for (const Ellipsoid& body : {Ellipsoid{6378137, 1 / 298.257223563}, Ellipsoid{1737400, 0},
                                Ellipsoid{245, 0.1}, Ellipsoid{13000, 0.3}})
    for (const double height : {-0.02, 0.0, 0.001, 0.5})
      for (double lat = -kPi / 2; lat <= kPi / 2; lat += kPi / 24)
        for (const double lon : {-3.0, 0.0, 1.5}) {
          const double height_m = height * body.semi_major_m;
          const Geodetic found = geodetic_of(body, body_fixed(body, {{lon, lat}, height_m}));
          EXPECT_NEAR(found.height_m, height_m, 1e-15 * body.semi_major_m + 4e-9);
          EXPECT_NEAR(found.lon_lat.lat_rad, lat, 3e-15) << body.flattening << ' ' << height;
          if (std::abs(lat) < 1.57) {
            EXPECT_NEAR(found.lon_lat.lon_rad, lon, 1e-15);
          }
        }
}

TEST(Geodetic, TheCentreOfTheBodyHasNoPlace) {
  EXPECT_TRUE(std::isnan(geodetic_of({6378137, 0}, {0, 0, 0}).height_m));
}

/// The longitudes from low to high across the seam, degrees; empty: none lie across it.
std::vector<double> across(const std::vector<double>& longitudes_deg) {
  GeodeticExtentSearch search;
  for (const double lon : longitudes_deg) search.add({lon * kDegree, 0.1});
  const auto extent = search.across_seam();
  if (!extent) return {};
  EXPECT_EQ(extent->low.lat_rad, 0.1);
  return {extent->low.lon_rad / kDegree, extent->high.lon_rad / kDegree};
}

void expect_across(const std::vector<double>& longitudes_deg, double low, double high) {
  const std::vector<double> found = across(longitudes_deg);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0], low, 1e-12);
  EXPECT_NEAR(found[1], high, 1e-12);
}

TEST(GeodeticExtent, LiesAcrossTheSeamWhereTheWidestGapIsAnother) {
  expect_across({179.9999, -179.9998, 180, 179.99995}, 179.9999, 180.0002);
  expect_across({359.9, 0.2, 0, 360}, 359.9, 360.2);
  expect_across({-100, 100}, 100, 260);
  expect_across({10, 120, -150}, 10, 210);
}

TEST(GeodeticExtent, LiesOnOneSideOtherwise) {
  for (const std::vector<double>& longitudes : {std::vector{12.0, 13.0},
                                                {-0.1, 0.1},
                                                {0.0, 120.0},
                                                {179.0, 180.0},
                                                {-180.0, -179.0},
                                                {400.0, 401.0},
                                                {5.0}})
    EXPECT_TRUE(across(longitudes).empty());
  std::vector<double> around;
  for (int i = 0; i < 3600; ++i) around.push_back(-180 + i / 10.0);
  EXPECT_TRUE(across(around).empty()) << "points around the body";
  EXPECT_TRUE(across({}).empty());
  EXPECT_TRUE(across({kNan}).empty());
}

}  // namespace
}  // namespace landfall
