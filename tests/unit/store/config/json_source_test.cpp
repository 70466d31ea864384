// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/core/error.h"
#include "refusal.h"
#include "store/config/import_config.h"
#include "store/config/json_source.h"
#include "store/config/presets.h"
#include "store/config/schema.h"
#include "store/config/stage_sections.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

std::string json_refusal(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "source.json";
  std::ofstream(path) << text;
  return refusal([&] { return read_json(path.string()); });
}

TEST(ReadJson, Comments) {
  EXPECT_EQ(json_refusal("// a lidar\n{\"a\": 1, /* not 2 */ \"b\": \"// text\"} // end"), "accepted");
  EXPECT_THAT(json_refusal("{\"a\": 1} /* open"), HasSubstr("not valid JSON"));
  EXPECT_THAT(json_refusal("{\"a\": 1, // first\n \"a\": 2}"), HasSubstr("given twice"));
}

TEST(ReadJson, MissingFileAndWrongContent) {
  EXPECT_THROW(static_cast<void>(read_json("/nonexistent/a.json")), UsageError);
}

TEST(ReadJson, AMessageQuotesTheEndOfALongText) {
  const std::string end(57, 'x');
  const std::string text = "\"" + std::string(3000, 'x');
  EXPECT_THAT(json_refusal("{" + text),
              HasSubstr("missing closing quote; last read: '..." + end + "'; expected string literal"));
  EXPECT_THAT(json_refusal("{\"a\": " + text),
              testing::EndsWith("missing closing quote; last read: '..." + end + "'"));
  EXPECT_THAT(json_refusal("{\"a\": nil}"), testing::EndsWith("last read: '\"a\": ni'"));
}

TEST(ReadJson, NanAndInfinityAreNotJson) {
  EXPECT_THAT(json_refusal("{\"a\": -Infinity}"), HasSubstr("not valid JSON"));
}

TEST(ReadJson, AKeyStandsOnce) {
  EXPECT_THAT(json_refusal("{\"a\": {\"b\": 1, \"b\": 2}}"), HasSubstr("\"b\" is given twice"));
  EXPECT_EQ(json_refusal("{\"a\": {\"b\": 1}, \"c\": {\"b\": 2}}"), "accepted");
}

std::string nested(std::size_t depth) {
  return R"({"a":)" + std::string(depth - 1, '[') + std::string(depth - 1, ']') + "}";
}

TEST(ReadJson, DeepNestingIsRefused) {
  EXPECT_EQ(json_refusal(nested(64)), "accepted");
  EXPECT_THAT(json_refusal(nested(65)), HasSubstr(": is nested deeper than 64 levels"));
  EXPECT_THAT(json_refusal(nested(200'000)), HasSubstr(": is nested deeper than 64 levels"));
  std::string key = "a";
  for (int i = 0; i < 80'000; ++i) key += ".a";
  JsonSource source{"config", nlohmann::json::object()};
  EXPECT_THROW(apply_assignments(source, {key + "=1"}), UsageError);
}

// A list's entries must not be looked at once more for each entry.
TEST(ReadJson, LongListsTakeLinearTime) {
  const auto ticks = [](std::size_t count) {
    std::string text = R"({"a": [)";
    for (std::size_t i = 0; i < count; ++i) text += R"({"x":1},)";
    text += R"({"x":1}]})";
    const std::clock_t start = std::clock();  // processor time, which other programs do not change
    EXPECT_EQ(parse_json(text, "config").value.at("a").size(), count + 1);
    return static_cast<double>(std::clock() - start);
  };
  const double few = std::min(ticks(20'000), ticks(20'000));
  EXPECT_LT(std::min(ticks(200'000), ticks(200'000)), 40 * few);
}

TEST(ReadJson, LongKeysAreCut) {
  const std::string key(1'000'000, 'k');
  EXPECT_LT(json_refusal(R"({")" + key + R"(": 1, ")" + key + R"(": 2})").size(), 300U);
}

TEST(Assignments, MakeReplaceAndIndex) {
  JsonSource source{"config", {{"list", {1, 2}}}};
  apply_assignments(source, {"a.b=1.5", "a.c=\"text\"", "list.1=7", "a.b=[1,2]"});
  EXPECT_EQ(source.value, nlohmann::json::parse(R"({"a": {"b": [1,2], "c": "text"}, "list": [1, 7]})"));
}

TEST(Assignments, AnIndexOfADefaultArray) {
  const auto default_at = [](const nlohmann::json& config, const std::string& pointer) {
    EXPECT_FALSE(config.contains("list"));
    return pointer == "/a/list" ? nlohmann::json({1, 2, 3}) : nlohmann::json();
  };
  JsonSource source{"config", {{"b", 1}}};
  apply_assignments(source, {"a.list.1=7"}, default_at);
  EXPECT_EQ(source.value, nlohmann::json({{"b", 1}, {"a", {{"list", {1, 7, 3}}}}}));
  apply_assignments(source, {"a.list.0=8", "a.other.0=9"}, default_at);  // an array that exists; no array
  EXPECT_EQ(source.value["a"], nlohmann::json({{"list", {8, 7, 3}}, {"other", {{"0", 9}}}}));
  JsonSource other{"config", nlohmann::json::object()};
  EXPECT_THROW(apply_assignments(other, {"a.list.3=7"}, default_at), UsageError);
}

TEST(Assignments, AWordIsAText) {
  JsonSource source{"config", nlohmann::json::object()};
  apply_assignments(source, {"a=text", "b=NaN", "c=0,01", "d=1e3", "e=true"});
  EXPECT_EQ(source.value,
            nlohmann::json::parse(R"({"a": "text", "b": "NaN", "c": "0,01", "d": 1000.0, "e": true})"));
}

TEST(Assignments, RefuseWhatIsNoAssignment) {
  JsonSource source{"config", {{"list", {1, 2}}, {"x", 3}}};
  for (const char* const wrong :
       {"a", "=1", "a=", "a={", "a=[1", "a=\"open", "a.=1", "list.2=1", "list.b=1", "x.y=1"})
    EXPECT_THROW(apply_assignments(source, {wrong}), UsageError) << wrong;
}

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

/// /terrain/from after expand_stage_sections().
std::string placed(const std::string& from, const std::string& folder) {
  JsonSource source{"c.json", {{"terrain", {{"from", from}}}}};
  expand_stage_sections(source, folder);
  return source.value["terrain"]["from"];
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
  EXPECT_THAT(preset_refusal({"preset:zzzzzzzz"}, "scan"), HasSubstr("known: alhat-flash-mosaic, atm-t3"));
  EXPECT_THAT(preset_refusal({"preset:"}, "scan"), HasSubstr("there is no such preset"));
  EXPECT_THAT(preset_refusal({"preset:paper"}, "eval"), HasSubstr("this tool has none"));
}

}  // namespace
}  // namespace landfall
