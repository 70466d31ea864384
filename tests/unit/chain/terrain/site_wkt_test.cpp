// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/site_wkt.h"

#include <gtest/gtest.h>

#include <string>

#include "chain/terrain/relief/dem_raster.h"

namespace landfall {
namespace {

const std::string kFrame = R"(PROJCRS["site frame",BASEGEOGCRS["x"]])";
const MapPlace kPlace{.center = {500000.125, -5400000, 0.1},
                      .metres_per_unit = 1200.0 / 3937.0,
                      .vertical = "EGM96 geoid; of 1996",
                      .map_wkt = R"(PROJCRS["Cote d'Ivoire: map: x",ID["EPSG",1]])"};

TEST(SiteWkt, APlaceIsReadAsItWasWritten) {
  const std::string placed = with_place(kFrame, kPlace);
  MapPlace expected = kPlace;
  expected.vertical = "EGM96 geoid, of 1996";
  EXPECT_EQ(place_of(placed), expected);
  EXPECT_EQ(map_wkt_of(placed), kPlace.map_wkt);
  EXPECT_EQ(without_place(placed), kFrame);
  EXPECT_EQ(placed.find('"', placed.find("REMARK[\"") + 8), placed.size() - 3)
      << "no quote inside the remark";
}

TEST(SiteWkt, AnotherPlaceReplacesTheFirst) {
  const MapPlace other{.center = {1, 2, 3}, .metres_per_unit = 1, .vertical = {}, .map_wkt = {}};
  EXPECT_EQ(place_of(with_place(with_place(kFrame, kPlace), other)), other);
  EXPECT_EQ(place_of(with_place(kLocalSiteCrsWkt, other)), other);
}

TEST(SiteWkt, AFrameWithoutAPlaceHasNone) {
  EXPECT_EQ(place_of(kLocalSiteCrsWkt), std::nullopt);
  EXPECT_EQ(place_of(""), std::nullopt);
  EXPECT_EQ(map_wkt_of(kFrame), "");
  EXPECT_EQ(without_place(kFrame), kFrame);
  EXPECT_EQ(with_place("no WKT", kPlace), "no WKT");
}

TEST(SiteWkt, ARemarkOfTheMapAloneIsThatOfVersion020) {
  const std::string old = R"(PROJCRS["site frame",BASEGEOGCRS["x"],REMARK["map: PROJCRS['UTM']"]])";
  EXPECT_EQ(place_of(old), std::nullopt);
  EXPECT_EQ(map_wkt_of(old), R"(PROJCRS["UTM"])");
  EXPECT_EQ(without_place(old), kFrame);
}

TEST(SiteWkt, RemarksOfOthersAreNoPlace) {
  const std::string other = R"(PROJCRS["site frame",REMARK["taken from a map"]])";
  EXPECT_EQ(place_of(other), std::nullopt);
  EXPECT_EQ(map_wkt_of(other), "");
  EXPECT_EQ(without_place(other), other);
  EXPECT_EQ(place_of(R"(PROJCRS["x",REMARK["center: 1, two, 3; unit: 1"]])"), std::nullopt);
  EXPECT_EQ(place_of(R"(PROJCRS["x",REMARK["center: 1, 2, 3; unit: "]])"), std::nullopt);
}

TEST(SiteWkt, RaisingMovesTheHeightOfTheCentre) {
  EXPECT_EQ(place_of(raised(with_place(kFrame, kPlace), 10))->center[2], 10.1);
  EXPECT_EQ(raised(kFrame, 10), kFrame);
}

}  // namespace
}  // namespace landfall
