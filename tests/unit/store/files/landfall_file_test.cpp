// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "chain/terrain/relief/dem_raster.h"
#include "store/files/grid_mapping.h"
#include "store/files/landfall_file.h"
#include "store/files/stored_json.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::Pair;

/// A file whose provenance has these texts in the place of its own.
LandfallFileReader with_provenance(const std::filesystem::path& path,
                                   const std::vector<std::pair<std::string, std::string>>& texts) {
  {
    LandfallFileWriter file({path, true}, "terrain", {.tool = "terrain-gen", .config = {{"a", 1}}});
    const h5::Handle group(H5Gopen2(file.root(), "provenance", H5P_DEFAULT), H5Gclose);
    for (const auto& [name, text] : texts) {
      H5Ldelete(group.get(), name.c_str(), H5P_DEFAULT);
      h5::write_text(group.get(), {name, "a text"}, text);
    }
    file.commit();
  }
  return {path, {"terrain"}};
}

// Whoever reads a configuration asks it for keys.
TEST(LandfallFile, AConfigurationIsAnObjectOrNone) {
  const TemporaryFolder folder;
  EXPECT_EQ(with_provenance(folder / "a.h5", {}).config(), Json({{"a", 1}}));
  for (const char* const text : {"[1]", "5", "\"text\"", "{", ""})
    EXPECT_TRUE(with_provenance(folder / "a.h5", {{"config_json", text}}).config().is_null()) << text;
}

TEST(LandfallFile, InputsHaveARoleAndAnId) {
  const TemporaryFolder folder;
  const auto inputs = [&](const char* text) {
    return with_provenance(folder / "a.h5", {{"inputs_json", text}}).chain().back().at("inputs");
  };
  EXPECT_EQ(inputs(R"([{"role": "terrain", "file_id": "f"}])").size(), 1U);
  for (const char* const text :
       {"5", "{}", "[5]", R"([{"role": 5, "file_id": "f"}])", R"([{"role": "terrain"}])"})
    EXPECT_TRUE(inputs(text).is_null()) << text;
}

TEST(LandfallFile, AHistoryThatIsNotUnderstoodIsLeftOut) {
  const TemporaryFolder folder;
  const auto steps = [&](const std::string& text) {
    return with_provenance(folder / "a.h5", {{"chain_json", text}}).chain().size();
  };
  const std::string step = R"({"tool": "scan-sim", "file_id": "f")";
  EXPECT_EQ(steps("[" + step + "}]"), 2U);
  EXPECT_EQ(steps("[" + step + R"(, "version": "0.1", "inputs": []}])"), 2U);
  EXPECT_EQ(steps("[" + step + R"(, "version": 1}])"), 1U);
  EXPECT_EQ(steps("[" + step + R"(, "inputs": [{"role": 1, "file_id": "f"}]}])"), 1U);
}

// An attribute holds less than 64 KiB.
TEST(LandfallFile, HistoryHasALinePerStepUpToALimit) {
  const TemporaryFolder folder;
  const auto history = [&](std::size_t upstream) {
    Provenance made{.tool = "regrid"};
    for (std::size_t i = 0; i < upstream; ++i)
      made.chain.push_back({{"tool", "scan-sim"}, {"version", "0.1"}, {"file_id", "id" + std::to_string(i)}});
    LandfallFileWriter(OutputOptions{folder / "a.h5", true}, "dem", made).commit();
    return *h5::read_text_attribute(LandfallFileReader(folder / "a.h5", {"dem"}).root(), "history");
  };
  const std::string last =
      "landfall regrid " + program_version() + ", file_id " + Provenance{.tool = "regrid"}.file_id();
  EXPECT_EQ(history(0), last);
  EXPECT_EQ(history(1), "landfall scan-sim 0.1, file_id id0\n" + last);
  const std::string many = history(1000);
  EXPECT_TRUE(
      many.starts_with("801 earlier steps: /provenance/chain_json\nlandfall scan-sim 0.1, file_id id801\n"));
  EXPECT_TRUE(many.ends_with(last));
  EXPECT_LT(many.size(), 65536U);
}

TEST(LandfallFile, ClaimsCfUnlessThatIsWithdrawn) {
  const TemporaryFolder folder;
  for (const bool follows : {true, false}) {
    LandfallFileWriter file({folder / "a.h5", true}, "dem", {.tool = "test"});
    if (!follows) file.withdraw_cf_claim();
    file.commit();
    const LandfallFileReader read(folder / "a.h5", {"dem"});
    EXPECT_EQ(h5::read_text_attribute(read.root(), "Conventions").value_or("none"),
              follows ? "CF-1.8" : "none");
  }
}

// A function that walks JSON calls itself: 10^5 levels would end the program.
TEST(StoredJson, DeepTextsAreNone) {
  const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_TRUE(is_storable_json(nested(kMaxStoredLevels)));
  EXPECT_FALSE(is_storable_json(nested(kMaxStoredLevels + 1)));
  EXPECT_FALSE(is_storable_json(std::string(1'000'000, '[')));
  std::string spaced = "[[],[],[]]";
  spaced.insert(1, 1000, ' ');
  EXPECT_TRUE(is_storable_json(spaced));
  EXPECT_TRUE(stored_json<Json>(nested(1'000'000)).is_null());
  EXPECT_TRUE(stored_json<Json>(std::nullopt).is_null());
  EXPECT_EQ(stored_json<Json>("{\"a\": 1}"), Json({{"a", 1}}));
}

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
