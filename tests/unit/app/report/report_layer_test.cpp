// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/report_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "base/dictionary/layers.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/hazards/safety.h"

namespace landfall::html_report {
namespace {

using testing::ElementsAre;

TEST(Dictionary, EveryLayerOfAReportHasAKnownStyleAndRule) {
  int shown = 0;
  for (const dictionary::Layer& words : dictionary::kLayers) {
    if (std::string(words.title).empty()) continue;
    const ReportLayer layer = described(words.file, words.name);
    EXPECT_EQ(layer_json(layer, "id").at("style"), words.style) << words.name;
    EXPECT_EQ(layer_json(layer, "id").at("rule"), words.rule) << words.name;
    ++shown;
  }
  EXPECT_GT(shown, 30);
}

TEST(Dictionary, UnknownLayersAreRefused) {
  EXPECT_EQ(dictionary::find_layer("dem", "p_safe"), nullptr);
  EXPECT_THROW((void)described("dem", "p_safe"), std::logic_error);
}

TEST(Dictionary, UnitsAreThoseThatPeopleRead) {
  EXPECT_EQ(described("hazards", "slope").unit, "deg");
  EXPECT_EQ(described("hazards", "cost").unit, "");
  EXPECT_EQ(described("dem", "z_est").unit, "m");
}

TEST(Dictionary, PlaceClassesHaveTheValuesOfTheCode) {
  const auto value_of = [](const char* layer, const std::string& name) {
    for (const dictionary::PlaceClass& c : dictionary::place_classes(layer))
      if (c.name == name) return c.value;
    return -1;
  };
  EXPECT_EQ(value_of("safe", "hazard"), static_cast<int>(Safety::hazard));
  EXPECT_EQ(value_of("safe", "safe"), static_cast<int>(Safety::safe));
  EXPECT_EQ(value_of("safe", "unknown"), static_cast<int>(Safety::unknown));
  EXPECT_EQ(value_of("outcome", "hazard found"), static_cast<int>(HazardOutcome::hazard_found));
  EXPECT_EQ(value_of("outcome", "safe found"), static_cast<int>(HazardOutcome::safe_found));
  EXPECT_EQ(value_of("outcome", "missed hazard"), static_cast<int>(HazardOutcome::missed_hazard));
  EXPECT_EQ(value_of("outcome", "false alarm"), static_cast<int>(HazardOutcome::false_alarm));
  EXPECT_EQ(value_of("outcome", "unknown"), static_cast<int>(HazardOutcome::unknown));
}

// The bits are those of old files, too.
TEST(Dictionary, BitsOfTheLayerFail) {
  EXPECT_EQ(fail_relative_x, 1);
  EXPECT_EQ(fail_relative_y, 2);
  EXPECT_EQ(fail_relative_z, 4);
  EXPECT_EQ(fail_absolute_horizontal, 8);
  EXPECT_EQ(fail_hole_size, 16);
  EXPECT_EQ(fail_hole_distance, 32);
  std::vector<int> bits;
  for (const dictionary::FailFlag& flag : fail_flags_by_bit()) bits.push_back(flag.bit);
  EXPECT_THAT(bits, ElementsAre(1, 2, 4, 8, 16, 32));
}

}  // namespace
}  // namespace landfall::html_report
