// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/import_config.h"

#include <gtest/gtest.h>

#include "refusal.h"

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

TEST(ImportConfig, AGridThatIsNoneIsRefused) {
  const Json config = {{"grid", 5}};
  EXPECT_EQ(refused(config, sizes("60", "")),
            "c.json: /grid: is not an object, so --half-width cannot be set");
  EXPECT_EQ(refused(config, sizes("", "1")),
            "c.json: /grid: is not an object, so --resolution cannot be set");
}

}  // namespace
}  // namespace landfall
