// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/grid_mapping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "chain/terrain/relief/dem_raster.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::string degree(const char* name, const char* value) {
  return "PARAMETER[\"" + std::string(name) + "\"," + value + R"(,ANGLEUNIT["degree",0.0174532925199433]])";
}

/// A projected CRS of a sphere of 1000 m.
std::string crs(const std::string& method, const std::string& parameters, const std::string& unit = "1",
                const std::string& ellipsoid = "1000,0") {
  return R"(PROJCRS["site", BASEGEOGCRS["g",DATUM["d",ELLIPSOID["e",)" + ellipsoid +
         R"(,LENGTHUNIT["metre",1]]],PRIMEM["p",0,ANGLEUNIT["degree",0.0174532925199433]]],CONVERSION["c",METHOD[")" +
         method + "\"]," + parameters +
         R"(,PARAMETER["False easting",500,LENGTHUNIT["metre",1]],PARAMETER["False northing",-2,LENGTHUNIT["km",1000]]],)" +
         R"wkt(CS[Cartesian,2],AXIS["(E)",east,ORDER[1],LENGTHUNIT["u",)wkt" + unit +
         R"wkt(]],AXIS["(N)",north,ORDER[2],LENGTHUNIT["u",)wkt" + unit + "]]]";
}

std::string sinusoidal() { return crs("Sinusoidal", degree("Longitude of natural origin", "20.5")); }

TEST(GridMapping, HasParametersInDegreesAndMetresAndNames) {
  const auto mapping = grid_mapping_of(sinusoidal());
  ASSERT_TRUE(mapping.has_value());
  EXPECT_THAT(mapping->texts,
              ElementsAre(Pair("grid_mapping_name", "sinusoidal"), Pair("geographic_crs_name", "g"),
                          Pair("horizontal_datum_name", "d"), Pair("reference_ellipsoid_name", "e"),
                          Pair("prime_meridian_name", "p"), Pair("projected_crs_name", "site")));
  EXPECT_THAT(mapping->numbers,
              ElementsAre(Pair("longitude_of_projection_origin", ElementsAre(20.5)),
                          Pair("false_easting", ElementsAre(500)), Pair("false_northing", ElementsAre(-2000)),
                          Pair("earth_radius", ElementsAre(1000)),
                          Pair("longitude_of_prime_meridian", ElementsAre(0))));
}

TEST(GridMapping, KeepsTheFlatteningAndJoinsStandardParallels) {
  const std::string cone = degree("Latitude of false origin", "1") + "," +
                           degree("Longitude of false origin", "2") + "," +
                           degree("Latitude of 1st standard parallel", "30") + "," +
                           degree("Latitude of 2nd standard parallel", "40");
  const auto mapping = grid_mapping_of(crs("Albers Equal Area", cone, "1", "1000,300"));
  ASSERT_TRUE(mapping.has_value());
  EXPECT_THAT(mapping->numbers, testing::Contains(Pair("standard_parallel", ElementsAre(30, 40))));
  EXPECT_THAT(mapping->numbers, testing::Contains(Pair("semi_major_axis", ElementsAre(1000))));
  EXPECT_THAT(mapping->numbers, testing::Contains(Pair("inverse_flattening", ElementsAre(300))));
}

TEST(GridMapping, ConvertsOtherAngles) {
  const auto mapping = grid_mapping_of(crs(
      "Sinusoidal", R"(PARAMETER["Longitude of natural origin",50,ANGLEUNIT["grad",0.015707963267949]])"));
  ASSERT_TRUE(mapping.has_value());
  EXPECT_NEAR(mapping->numbers[0].second[0], 45, 1e-9);
}

TEST(GridMapping, ThePoleIsThatOfTheStandardParallel) {
  const std::string longitude = "," + degree("Longitude of origin", "0");
  for (const double sign : {1.0, -1.0}) {
    const char* const latitude = sign > 0 ? "70" : "-70";
    const auto mapping = grid_mapping_of(crs("Polar Stereographic (variant B)",
                                             degree("Latitude of standard parallel", latitude) + longitude));
    ASSERT_TRUE(mapping.has_value());
    EXPECT_THAT(mapping->numbers,
                testing::Contains(Pair("latitude_of_projection_origin", ElementsAre(90 * sign))));
  }
}

TEST(GridMapping, IsMissingWhereCfCannotSayIt) {
  EXPECT_FALSE(grid_mapping_of(kLocalSiteCrsWkt).has_value());
  EXPECT_FALSE(grid_mapping_of(crs("Equidistant Cylindrical", degree("Longitude of natural origin", "0")))
                   .has_value());
  EXPECT_FALSE(grid_mapping_of(crs("Sinusoidal", degree("Longitude of another origin", "0"))).has_value());
  EXPECT_FALSE(
      grid_mapping_of(crs("Sinusoidal", degree("Longitude of natural origin", "0"), "0.3048")).has_value());
  EXPECT_FALSE(grid_mapping_of(crs("Sinusoidal", degree("Longitude of natural origin", "nan"))).has_value());
}

TEST(GridMapping, EveryPartOfATextIsRefusedWithoutTheRest) {
  const std::string wkt = sinusoidal();
  for (std::size_t size = 0; size < wkt.size(); ++size)
    EXPECT_FALSE(grid_mapping_of(wkt.substr(0, size)).has_value()) << size;
  EXPECT_FALSE(grid_mapping_of(wkt + "]").has_value());
  EXPECT_TRUE(grid_mapping_of(" " + wkt + "\n").has_value());
}

TEST(GridMapping, DepthIsLimited) {
  std::string deep;
  for (int i = 0; i < 1000000; ++i) deep += "A[";
  EXPECT_FALSE(grid_mapping_of(deep).has_value());
  EXPECT_FALSE(is_local_crs(deep));
}

TEST(GridMapping, KnowsLocalFrames) {
  EXPECT_TRUE(is_local_crs(kLocalSiteCrsWkt));
  EXPECT_TRUE(is_local_crs(R"(LOCAL_CS["lander",UNIT["metre",1]])"));
  EXPECT_FALSE(is_local_crs(sinusoidal()));
  EXPECT_FALSE(is_local_crs("ENGCRS"));
}

}  // namespace
}  // namespace landfall
