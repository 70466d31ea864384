// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/import_config.h"

#include <gtest/gtest.h>

#include "refusal.h"
#include "store/config/stage_sections.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

ImportOptions sizes(const std::string& half_width, const std::string& resolution) {
  ImportOptions options;
  options.half_width = half_width;
  options.resolution = resolution;
  return options;
}

std::string refused(const Json& config, const ImportOptions& options) {
  JsonSource source{"c.json", config};
  return refusal([&] { apply_import(source, options); });
}

TEST(ImportConfig, SizesGoIntoTheGrid) {
  JsonSource source{"c.json", {{"grid", {{"resolution_m", 3}}}}};
  ImportOptions options = sizes("60", "0.5");
  options.from = "a.tif";
  apply_import(source, options);
  EXPECT_EQ(source.value["grid"], Json({{"half_width_m", 60}, {"resolution_m", 0.5}}));
  EXPECT_EQ(source.value["base"], Json({{"type", "dem"}, {"path", "a.tif"}}));
}

TEST(ImportConfig, TheRestOfTheBaseIsMergedOverTheImport) {
  JsonSource source{"c.json", {{"base", {{"datum", "none"}, {"center_pixel", {1, 2}}}}}};
  ImportOptions options;
  options.from = "a.tif";
  options.band = "2";
  apply_import(source, options);
  EXPECT_EQ(
      source.value["base"],
      Json({{"type", "dem"}, {"path", "a.tif"}, {"band", 2}, {"datum", "none"}, {"center_pixel", {1, 2}}}));
  EXPECT_EQ(refused({{"base", {{"band", 2}}}}, options),
            "c.json: /base/band: the import gives it too; remove one");
}

/// /terrain/from after place_import().
std::string placed(const std::string& from, const std::string& folder) {
  Json config = {{"terrain", {{"from", from}}}};
  place_import(config, folder);
  return config["terrain"]["from"];
}

TEST(ImportConfig, ARasterLiesBesideTheFileThatNamesIt) {
  EXPECT_EQ(placed("a.tif", ""), "a.tif");
  EXPECT_EQ(placed("a.tif", "chains"), "chains/a.tif");
  EXPECT_EQ(placed("/data/a.tif", "chains"), "/data/a.tif");
  EXPECT_EQ(placed("NETCDF:\"a.h5\":z", "chains"), "NETCDF:\"a.h5\":z");
}

TEST(ImportConfig, AGridThatIsNoneIsRefused) {
  const Json config = {{"grid", 5}};
  EXPECT_EQ(refused(config, sizes("60", "")),
            "c.json: /grid: is not an object, so --half-width cannot be set");
  EXPECT_EQ(refused(config, sizes("", "1")),
            "c.json: /grid: is not an object, so --resolution cannot be set");
}

}  // namespace
}  // namespace landfall
