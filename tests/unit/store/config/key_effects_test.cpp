// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/key_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(KeyEffects, FollowTheSchema) {
  for (const char* const key :
       {"/detector/rows", "/laser/pulse_rate_hz", "/scanner/pattern/half_width_m", "/mount/rpy_deg/2",
        "/trajectory/position_m", "/trajectory_dispersion/rpy_rad", "/scanner/pattern/aim",
        "/pointing_error/jitter_sigma_rad", "/pointing_error/mirror_time_bias_s"})
    EXPECT_EQ(effect_of(key), KeyEffect::beam) << key;
  for (const char* const key : {"/beam/divergence_rad", "/surface/albedo", "/link/background_pe",
                                "/receiver/type", "/receiver/threshold_pe", "/receiver/returns"})
    EXPECT_EQ(effect_of(key), KeyEffect::echo) << key;
  for (const char* const key :
       {"/noise/range_sigma_m", "/receiver/jitter_sigma_s", "/receiver/pixel_offset_table/path",
        "/pointing_error/time_stamp_bias_s", "/navigation_error/gauss_markov/rpy_sigma_rad/1"})
    EXPECT_EQ(effect_of(key), KeyEffect::estimate) << key;
}

TEST(KeyEffects, TakeTheStrictestOfSeveralScannersAndOfAnUnknownKey) {
  EXPECT_EQ(effect_of("/scanner/encoder_sigma_rad"), KeyEffect::beam);  // fsm: estimate, risley: beam
  EXPECT_EQ(effect_of("/noise/unknown"), KeyEffect::estimate);
  EXPECT_EQ(effect_of("/unknown"), std::nullopt);
  EXPECT_EQ(effect_of("/seed"), std::nullopt);
}

std::vector<std::string> drawn_beams(const Json& config) {
  std::vector<std::string> keys;
  for (const EffectiveKey& key : keys_in_effect(config))
    if (key.is_drawn && key.effect == KeyEffect::beam) keys.push_back(key.pointer);
  return keys;
}

TEST(KeyEffects, KnowWhichKeysMoveTheBeamsByTheSeed) {
  EXPECT_THAT(drawn_beams(Json::object()), IsEmpty());
  EXPECT_THAT(drawn_beams({{"pointing_error", {{"jitter_sigma_rad", {0, 0}}}}}), IsEmpty());
  EXPECT_THAT(drawn_beams({{"pointing_error", {{"jitter_sigma_rad", {0, 1e-5}}}}}),
              ElementsAre("/pointing_error/jitter_sigma_rad"));
  EXPECT_THAT(drawn_beams({{"scanner", {{"type", "fsm"}, {"encoder_sigma_rad", 1e-5}}}}), IsEmpty());
  EXPECT_THAT(drawn_beams({{"scanner", {{"type", "risley"}, {"encoder_sigma_rad", 1e-5}}}}),
              ElementsAre("/scanner/encoder_sigma_rad"));
  EXPECT_THAT(drawn_beams({{"scanner", {{"type", "polygon"}, {"facet_tilt_sigma_rad", 1e-5}}}}),
              ElementsAre("/scanner/facet_tilt_sigma_rad"));
}

TEST(KeyEffects, NavigationErrorsMoveTheBeamsOfAPatternThatAimsFromTheEstimate) {
  const Json errors = {{"gauss_markov", {{"position_sigma_m", {0, 0.1, 0}}}}};
  const auto scan = [&](const char* aim) -> Json {
    return {{"scanner", {{"type", "fsm"}, {"pattern", {{"type", "line_search"}, {"aim", aim}}}}},
            {"navigation_error", errors}};
  };
  EXPECT_EQ(effect_of("/navigation_error/velocity_mps/0", scan("nominal")), KeyEffect::estimate);
  EXPECT_EQ(effect_of("/navigation_error/velocity_mps/0", scan("estimate")), KeyEffect::beam);
  EXPECT_EQ(effect_of("/noise/range_sigma_m", scan("estimate")), KeyEffect::estimate);
  EXPECT_EQ(effect_of("/seed", scan("estimate")), std::nullopt);
  EXPECT_THAT(drawn_beams(scan("nominal")), IsEmpty());
  EXPECT_THAT(drawn_beams(scan("estimate")), ElementsAre("/navigation_error/gauss_markov/position_sigma_m"));
}

TEST(KeyEffects, ReadConfigurationsOfAnyStructure) {
  for (const Json& config : {Json(), Json::array({1}), Json("text"), Json({{"noise", 3}, {"scanner", {1}}}),
                             Json({{"scanner", {{"type", 7}, {"encoder_sigma_rad", "x"}}}})})
    EXPECT_THAT(keys_in_effect(config), IsEmpty()) << config;
}

/// A wrong word in the schema would be read as another one.
void expect_words(const Json& node, std::set<std::string>& found) {
  static const std::set<std::string> kEffects = {"beam", "echo", "estimate"};
  static const std::set<std::string> kSigmas = {"range", "given", "navigation", "never"};
  if (node.is_object()) {
    if (node.contains("effect") && node["effect"].is_string()) {
      EXPECT_EQ(kEffects.count(node["effect"]), 1U) << node;
      found.insert(node["effect"]);
    }
    if (node.contains("sigma") && node["sigma"].is_string()) {
      EXPECT_EQ(kSigmas.count(node["sigma"]), 1U) << node;
      found.insert(node["sigma"]);
    }
    if (node.contains("drawn") && !node["drawn"].is_object()) {
      EXPECT_EQ(node["drawn"], true) << node;
    }
  }
  if (node.is_structured())
    for (const auto& item : node.items()) expect_words(item.value(), found);
}

TEST(KeyEffects, TheSchemaHasOnlyTheirWords) {
  std::set<std::string> found;
  expect_words(embedded_schema("scan"), found);
  EXPECT_EQ(found.size(), 7U);
  for (const auto& [section, schema] : embedded_schema("scan").at("properties").items())
    EXPECT_TRUE(schema.contains("effect") || section == "seed" || section == "draw" ||
                section.starts_with("$"))
        << section;
}

}  // namespace
}  // namespace landfall
