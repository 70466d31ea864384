// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/meeting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "chain/terrain/relief/dem_raster.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/gdal_loader.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string local(double x, double y, double z = 0, double unit = 1) {
  return with_place(kLocalSiteCrsWkt,
                    {.center = {x, y, z}, .metres_per_unit = unit, .vertical = {}, .map_wkt = {}});
}

/// The frame of points on a map.
std::string on_map(const std::string& crs, double x, double y) {
  PointFrameRequest request{
      .name = "points", .crs = {}, .low = {x, y}, .high = {x, y}, .center = MapPoint{x, y}};
  request.crs.option = crs;
  return point_frame(request).crs_wkt;
}

Meeting met(const std::string& a, const std::string& b, const char* kind = "scans", MeetingRules rules = {}) {
  return meeting_of(meeting_kind(kind), {"a.h5", a}, {"b.h5", b}, rules);
}

TEST(Meeting, EqualFramesNeedNoWord) {
  for (const std::string& frame :
       {std::string(kLocalSiteCrsWkt), local(1, 2), on_map("EPSG:32632", 5e5, 54e5)}) {
    const Meeting meeting = met(frame, frame);
    EXPECT_TRUE(meeting.placement.is_identity());
    EXPECT_TRUE(meeting.said.empty());
    EXPECT_EQ(meeting.refusal, "");
  }
  EXPECT_TRUE(met(kLocalSiteCrsWkt, local(0, 0)).said.empty()) << "a terrain without a site lies at 0, 0";
}

TEST(Meeting, ALocalFrameWithAnotherCentreIsMovedWithAWord) {
  const Meeting meeting = met(local(500000, 5400000), local(500012.5, 5399999, 3));
  EXPECT_THAT(meeting.placement.shift_m(), ElementsAre(12.5, -1, 3));
  EXPECT_THAT(meeting.said, ElementsAre(HasSubstr("moved by (12.5, -1, 3) m into the frame of a.h5")));
  EXPECT_THAT(met(local(10, 0, 0, 2), local(3, 0, 0, 10)).placement.shift_m(), ElementsAre(10, 0, 0))
      << "coordinates of one system in units of 2 m and 10 m";
}

TEST(Meeting, OneMapMovesByTheDifferenceOfTheCentres) {
  const Meeting meeting =
      met(on_map("EPSG:32632", 500000.1, 5400000), on_map("EPSG:32632", 500012.4, 5400000));
  EXPECT_EQ(meeting.placement.shift_m()[0], 500012.4 - 500000.1);
  EXPECT_FALSE(meeting.placement.is_reprojected());
  EXPECT_EQ(meeting.said.size(), 1U);
  const std::string by_text = on_map("+proj=utm +zone=32 +datum=WGS84", 500012.4, 5400000);
  EXPECT_EQ(met(on_map("EPSG:32632", 500000.1, 5400000), by_text).placement.shift_m()[0], 500012.4 - 500000.1)
      << "whatever the name of the map is";
}

/// The difference of the places of one point of the ground in two frames once they have met.
double mismatch_m(const std::string& a, const std::string& b) {
  const Meeting meeting = met(a, b);
  EXPECT_TRUE(meeting.placement.is_reprojected()) << meeting.refusal;
  const SitePoint in_b{30, -40};
  std::array<double, 1> x = {in_b.x_m};
  std::array<double, 1> y = {in_b.y_m};
  meeting.placement.to_first(x, y);
  const SitePoint back = meeting.placement.to_second({x[0], y[0]});
  EXPECT_NEAR(back.x_m, in_b.x_m, 1e-6);
  EXPECT_NEAR(back.y_m, in_b.y_m, 1e-6);
  const MapPosition at_a = map_positions(a, {{x[0], y[0]}}).front();
  const MapPosition at_b = map_positions(b, {in_b}).front();
  return std::hypot(*at_a.latitude_deg - *at_b.latitude_deg, *at_a.longitude_deg - *at_b.longitude_deg) *
         111e3;
}

TEST(Meeting, AnotherMapIsReprojected) {
  const std::string zone32 = on_map("EPSG:32632", 500000, 5400000);
  EXPECT_LT(mismatch_m(zone32, on_map("EPSG:32633", 58870, 5416300)), 1e-3);
  EXPECT_LT(mismatch_m(zone32, on_map("EPSG:4326", 9.0, 48.752)), 1e-3);
  EXPECT_LT(mismatch_m(on_map("EPSG:4326", 9.0, 48.752), on_map("EPSG:4326", 9.001, 48.752)), 1e-3);
}

TEST(Meeting, APointBeyondTheHorizonHasNoPlace) {
  const Meeting meeting = met(on_map("EPSG:4326", 0, 0), on_map("EPSG:4326", 179, 0));
  std::array<double, 1> x = {0};
  std::array<double, 1> y = {0};
  meeting.placement.to_first(x, y);
  EXPECT_TRUE(std::isnan(x[0]) && std::isnan(y[0]));
}

TEST(Meeting, GridsOfAnotherMapAreRefused) {
  const std::string refusal =
      met(on_map("EPSG:32632", 500000, 5400000), on_map("EPSG:32633", 58870, 5416300), "mask").refusal;
  EXPECT_THAT(
      refusal,
      HasSubstr(
          "b.h5: its frame is another one than that of a.h5: reproject it (gdalwarp -t_srs \"+proj=tmerc"));
  EXPECT_THAT(refusal, HasSubstr("--same-frame"));
  EXPECT_NE(met(on_map("EPSG:4326", 9, 48), on_map("EPSG:4326", 9.1, 48), "mask").refusal, "");
}

TEST(Meeting, OneCrsAloneIsRefused) {
  const std::string map = on_map("EPSG:32632", 500000, 5400000);
  EXPECT_THAT(met(map, local(500000, 5400000)).refusal,
              HasSubstr("b.h5: has no CRS, but a.h5 has one: give that of b.h5 with --crs"));
  EXPECT_THAT(met(local(500000, 5400000), map).refusal,
              HasSubstr("b.h5: has a CRS, but a.h5 has none: give that of a.h5 with --crs"));
  EXPECT_NE(met(map, kLocalSiteCrsWkt).refusal, "");
  const Meeting same = met(map, local(7, 8), "scans", {.same_frame = true});
  EXPECT_TRUE(same.placement.is_identity());
  EXPECT_EQ(same.refusal, "");
}

TEST(Meeting, VerticalDatums) {
  const std::string none = on_map("EPSG:32612", 500000, 4000000);
  const std::string egm08 = on_map("EPSG:32612+3855", 500000, 4000000);
  const std::string egm96 = on_map("EPSG:32612+5773", 500000, 4000000);
  const std::string ellipsoid = on_map("EPSG:4979", -111, 36);
  EXPECT_THAT(met(egm08, egm96).refusal,
              HasSubstr("vertical datum (EGM96 geoid) than those of a.h5 (EGM2008 geoid)"));
  EXPECT_THAT(met(egm08, ellipsoid).refusal, HasSubstr("ellipsoid WGS 84"));
  EXPECT_EQ(met(egm08, egm08).refusal, "");
  EXPECT_THAT(met(none, egm96).said, ElementsAre(HasSubstr("vertical datum of a.h5 is not known")));
  EXPECT_EQ(met(none, egm96).refusal, "");
  const Meeting as_is = met(egm08, egm96, "scans", {.vertical_as_is = true});
  EXPECT_EQ(as_is.refusal, "");
  EXPECT_TRUE(as_is.said.empty());
}

TEST(Meeting, DatumsWithoutAKnownShiftAreRefused) {
  EXPECT_NE(met(on_map("+proj=ortho +R=1737400 +lat_0=10", 0, 0), on_map("EPSG:4326", 0, 10)).refusal, "");
  const Meeting nad = met(on_map("EPSG:32612", 500000, 4000000), on_map("EPSG:26712", 500000, 4000000));
  ASSERT_EQ(nad.refusal, "");
  std::array<double, 1> x = {0};
  std::array<double, 1> y = {0};
  nad.placement.to_first(x, y);
  EXPECT_GT(std::hypot(x[0], y[0]), 50) << "NAD27 and WGS 84 are some 200 m apart";
}

TEST(Meeting, PlacesOfVersion020) {
  EXPECT_THAT(met(local(0, 0), local(std::nan(""), std::nan(""), std::nan(""))).said,
              testing::Contains(HasSubstr("not recorded")));
}

TEST(PlacedGrid, MovesByWholeBins) {
  const GridSpec grid{0.5, -10, -20, 21, 41};
  const GridSpec placed{0.5, -6, -25, 21, 41};
  EXPECT_EQ(placed_grid(grid, grid, Placement({-2.5 + 4e-7, 2, 7})), placed);
  EXPECT_EQ(placed_grid(grid, grid, Placement({-2.5 + 1e-6, 2, 7})), std::nullopt);
  EXPECT_EQ(placed_grid({0.25, 0, 0, 3, 3}, grid, Placement()), std::nullopt);
  EXPECT_EQ(placed_grid(grid, grid, Placement({1e12, 0, 0})), std::nullopt);
}

}  // namespace
}  // namespace landfall
