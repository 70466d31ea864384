// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/presets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "refusal.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using testing::HasSubstr;

std::string write_preset(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path) << text;
  return path.string();
}

std::string preset_refusal(const std::vector<std::string>& names, const std::string& schema) {
  return refusal([&] { return read_config(names, schema); });
}

TEST(Presets, EachHasADescriptionAndIsAValidConfiguration) {
  EXPECT_GE(presets("scan").size(), 5U);
  EXPECT_GE(presets("terrain").size(), 1U);
  EXPECT_GE(presets("hazard").size(), 2U);
  for (const char* schema : {"scan", "terrain", "hazard"})
    for (const Preset& preset : presets(schema)) {
      EXPECT_FALSE(preset.description.empty()) << preset.name;
      EXPECT_LE(preset.description.size(), 80U - 21U) << preset.name;  // one line of --list-presets
      const nlohmann::json config =
          resolve_config(read_config({"preset:" + preset.name}, schema), embedded_schema(schema));
      EXPECT_FALSE(config.contains("$comment"));
    }
  EXPECT_TRUE(presets("eval").empty());
}

TEST(ReadConfig, LaterFilesWinAndNullRemoves) {
  const std::string first = write_preset("a.json", R"({"a": {"b": 1, "c": [1, 2]}, "d": 4})");
  const std::string second = write_preset("b.json", R"({"a": {"c": [3]}, "d": null, "e": 5})");
  const JsonSource merged = read_config({first, second}, "scan");
  EXPECT_EQ(merged.value, nlohmann::json::parse(R"({"a": {"b": 1, "c": [3]}, "e": 5})"));
  EXPECT_EQ(merged.name, first + " + " + second);
  EXPECT_EQ(read_config({first}, "scan").name, first);
  EXPECT_EQ(read_config({}, "scan").value, nlohmann::json::object());
}

TEST(ReadConfig, AFileChangesAPreset) {
  const std::string change = write_preset("c.json", R"({"noise": {"range_sigma_m": 0.5}})");
  const nlohmann::json config = read_config({"preset:paper", change}, "scan").value;
  EXPECT_EQ(config["noise"]["range_sigma_m"], 0.5);
  EXPECT_EQ(config["scanner"]["type"], "fsm");
}

TEST(ReadConfig, UnknownPresets) {
  EXPECT_THAT(preset_refusal({"preset:papr"}, "scan"), HasSubstr("did you mean preset:paper?"));
  EXPECT_THAT(preset_refusal({"preset:zzzzzzzz"}, "scan"), HasSubstr("known: alhat-flash-mosaic, flash-256"));
  EXPECT_THAT(preset_refusal({"preset:"}, "scan"), HasSubstr("there is no such preset"));
  EXPECT_THAT(preset_refusal({"preset:paper"}, "eval"), HasSubstr("this tool has none"));
}

}  // namespace
}  // namespace landfall
