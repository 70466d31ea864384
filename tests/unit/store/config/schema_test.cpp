// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "refusal.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::string schema_refusal(const std::string& schema, const std::string& text) {
  return refusal([&] { return resolve_config({"c.json", Json::parse(text)}, embedded_schema(schema)); });
}

TEST(Schema, EmptyConfigResolvesToTheContractsDefaults) {
  const Json scan = resolve_config({"c", Json::object()}, embedded_schema("scan"));
  EXPECT_EQ(scan.at("detector").at("rows"), 18);
  EXPECT_EQ(scan.at("scanner").at("type"), "fsm");
  EXPECT_EQ(scan.at("scanner").at("pattern").at("at_end"), "wrap");
  EXPECT_EQ(scan.at("mount").at("rpy_deg"), Json({180, 0, 0}));
  EXPECT_EQ(scan.at("trajectory").at("velocity_mps"), Json({0, 0, -23}));
  const Json terrain = resolve_config({"c", Json::object()}, embedded_schema("terrain"));
  EXPECT_EQ(terrain.at("base"), Json::parse(R"({"type":"plane","elevation_m":0,"slope_x":0,"slope_y":0})"));
  const Json eval = resolve_config({"c", Json::object()}, embedded_schema("eval"));
  EXPECT_EQ(eval.at("limits").at("hole_bins"), 10);
}

TEST(Schema, EachIsOneObjectAndAnUnknownNameIsRefused) {
  const Json& scan = embedded_schema("scan");
  static_cast<void>(embedded_schema("terrain"));
  EXPECT_EQ(&embedded_schema("scan"), &scan);
  EXPECT_THROW(static_cast<void>(embedded_schema("lidar")), std::out_of_range);
}

TEST(Schema, VariantsAreChosenByType) {
  EXPECT_THAT(schema_refusal("scan", R"({"scanner": {"type": "flash", "pattern": {}}})"),
              HasSubstr("/scanner/pattern"));
  EXPECT_EQ(schema_refusal("scan", R"({"scanner": {"pattern": {"rows": 0}}})"),
            "c.json: /scanner/pattern/rows: 0 is not in [1, 1048576]");
  EXPECT_EQ(schema_refusal("scan", R"({"detector": {"ifov_rad": [1e-4, 2e-4]}})"), "accepted");
}

TEST(Schema, AVariantThatIsNoObjectIsToldItsForm) {
  const std::string wanted = " is not valid; expected object with a \"type\"";
  EXPECT_EQ(schema_refusal("scan", R"({"scanner": {"pattern": "spiral"}})"),
            "c.json: /scanner/pattern: \"spiral\"" + wanted + R"(; did you mean {"type": "spiral"}?)");
  EXPECT_EQ(schema_refusal("scan", R"({"scanner": "fms"})"),
            "c.json: /scanner: \"fms\"" + wanted + R"(; did you mean {"type": "fsm"}?)");
  EXPECT_EQ(schema_refusal("scan", R"({"scanner": "none of them"})"),
            "c.json: /scanner: \"none of them\"" + wanted);
  EXPECT_EQ(schema_refusal("scan", R"({"scanner": 3})"), "c.json: /scanner: 3" + wanted);
  EXPECT_EQ(schema_refusal("terrain", R"({"base": "plane"})"),
            "c.json: /base: \"plane\"" + wanted + R"( or array; did you mean {"type": "plane"}?)");
}

TEST(Schema, AConfigurationMayNameItsSchemaAndKeepsNoTraceOfIt) {
  for (const char* const name : {"terrain", "scan", "regrid", "eval"}) {
    const Json& schema = embedded_schema(name);
    EXPECT_TRUE(
        schema.at("$id").get<std::string>().starts_with(std::string("urn:landfall:schema:") + name + ":"));
    const Json named = Json::parse(R"({"$schema": "../schemas/x.schema.json"})");
    EXPECT_EQ(resolve_config({"c", named}, schema), resolve_config({"c", Json::object()}, schema)) << name;
  }
  EXPECT_EQ(schema_refusal("regrid", R"({"$schema": 7})"),
            "c.json: /$schema: 7 is of type integer, not string");
  EXPECT_THAT(schema_refusal("regrid", R"({"zzzzzzzz": 1})"), Not(HasSubstr("$schema")));
}

TEST(Schema, BasesMayBeStacked) {
  const Json terrain = resolve_config(
      {"c", Json::parse(R"({"base": [{"type": "plane", "slope_x": 0.1}, {"type": "fractal"}]})")},
      embedded_schema("terrain"));
  EXPECT_EQ(terrain.at("base").size(), 2U);
  EXPECT_EQ(terrain.at("base").at(1).at("hurst_exponent"), 0.8);
}

// The walk knows these keywords and ignores others.
void expect_known_keywords(const Json& schema) {
  static const std::string kKnown =
      " $id $ref $schema additionalProperties beam_with const default definitions description drawn effect "
      "enum "
      "exclusiveMaximum exclusiveMinimum items maxItems maximum minItems minLength minimum oneOf properties "
      "required sigma title type ";
  for (const auto& [key, value] : schema.items()) {
    EXPECT_THAT(kKnown, HasSubstr(" " + key + " "));
    if (key == "properties" || key == "definitions")
      for (const auto& [name, sub] : value.items()) expect_known_keywords(sub);
    if (key == "items" || (key == "additionalProperties" && value.is_object())) expect_known_keywords(value);
    if (key == "minLength") {
      EXPECT_EQ(value, 1);
    }
    if (key == "oneOf")
      for (const Json& sub : value) expect_known_keywords(sub);
  }
}

TEST(Schema, SchemasUseOnlyKnownKeywords) {
  for (const char* const name : {"terrain", "scan", "regrid", "eval", "hazard", "draws"})
    expect_known_keywords(embedded_schema(name));
}

TEST(NearestWord, SuggestsOnlyWhatIsNear) {
  EXPECT_EQ(nearest_word("colums", {"rows", "columns"}), "columns");
  EXPECT_EQ(nearest_word("abcdefgh", {"rows", "columns"}), "");
  EXPECT_EQ(nearest_word("rocks", {"power_law_rocks", "golombek_rocks", "craters"}), "golombek_rocks");
  EXPECT_EQ(nearest_word("row", {"narrow_field"}), "");  // too short to be a part
}

}  // namespace
}  // namespace landfall
