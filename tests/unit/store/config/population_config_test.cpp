// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "refusal.h"
#include "store/config/schema.h"
#include "store/config/terrain_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// The first pattern of a configuration that has the given ones.
FeaturePattern pattern_of(const std::string& patterns) {
  const Json config = Json::parse(R"({"patterns": [)" + patterns + "]}");
  return terrain_config(resolve_config({"c.json", config}, embedded_schema("terrain")), "c.json")
      .model.patterns.front();
}

std::string population_refusal(const std::string& patterns) {
  return refusal([&] { pattern_of(patterns); });
}

TEST(PopulationConfig, Defaults) {
  EXPECT_EQ(pattern_of(R"({"type": "golombek_rocks", "k": 0.1})"),
            FeaturePattern(RockPattern{{GolombekLaw{0.1}, {0.2, 5}}}));
  EXPECT_EQ(pattern_of(R"({"type": "power_law_rocks"})"),
            FeaturePattern(RockPattern{{kViperRocks, {0.2, 5}}}));
  EXPECT_EQ(pattern_of(R"({"type": "ice_blocks", "k": 0.2})"),
            FeaturePattern(IceBlockPattern{{GolombekLaw{0.2}, {0.3, 3}}, std::numbers::pi / 18}));
  EXPECT_EQ(pattern_of(R"({"type": "craters"})"),
            FeaturePattern(CraterPattern{{kTraskCraters, {1, 100}}, 0.1}));
}

TEST(PopulationConfig, EveryModelHasItsLaw) {
  const auto rocks = [](const std::string& keys) {
    return std::get<RockPattern>(pattern_of(R"({"type": "power_law_rocks", )" + keys + "}")).population.law;
  };
  EXPECT_EQ(rocks(R"("model": "viper")"), SizeLaw(kViperRocks));
  EXPECT_EQ(rocks(R"("model": "low_blocky")"), SizeLaw(kLowBlockyRocks));
  EXPECT_EQ(rocks(R"("model": "haworth")"), SizeLaw(kHaworthRocks));
  EXPECT_EQ(rocks(R"("model": "custom", "coefficient": 0.001, "exponent": 2)"), SizeLaw(PowerLaw{0.001, 2}));
  const auto craters = [](const std::string& keys) {
    return std::get<CraterPattern>(pattern_of(R"({"type": "craters", )" + keys + "}")).population.law;
  };
  EXPECT_EQ(craters(R"("model": "trask")"), SizeLaw(kTraskCraters));
  EXPECT_EQ(craters(R"("model": "viper")"), SizeLaw(ViperCraterLaw{}));
  EXPECT_EQ(craters(R"("model": "production", "coefficient": 0.2, "exponent": 2.9)"),
            SizeLaw(PowerLaw{0.2, 2.9}));
  const auto covering = std::get<RockPattern>(
      pattern_of(R"({"type": "golombek_rocks", "area_fraction": 0.01, "area_fraction_above_m": 0.3})"));
  EXPECT_NEAR(area_fraction(covering.population.law, {0.3, 1e3}), 0.01, 1e-14);
}

TEST(PopulationConfig, CommonKeysReachThePopulation) {
  const auto population = [](const std::string& keys) {
    return std::get<CraterPattern>(pattern_of(R"({"type": "craters", )" + keys + "}")).population;
  };
  const Population all = population(R"("min_diameter_m": 2, "max_diameter_m": 3, "overlap": false,
      "clear_radius_m": 4, "seed": 5, "region": {"type": "rectangle", "x_m": 6, "y_m": 7, "width_m": 8, "length_m": 9})");
  const Population expected{kTraskCraters, {2, 3}, RectangleRegion{{6, 7}, 8, 9}, 4, false, 5};
  EXPECT_EQ(all, expected);
  EXPECT_EQ(population(R"("region": {"type": "disc", "radius_m": 3})").region,
            Region(AnnulusRegion{{0, 0}, 0, 3}));
  EXPECT_EQ(population(R"("region": {"type": "annulus", "y_m": 1, "inner_radius_m": 2, "outer_radius_m": 3})")
                .region,
            Region(AnnulusRegion{{0, 1}, 2, 3}));
  EXPECT_EQ(population(R"("region": {"type": "site"})").region, Region(SiteRegion{}));
}

TEST(PopulationConfig, Lines) {
  Ridge ridge;
  ridge.length_m = 60;
  ridge.width_m = 2;
  ridge.height_m = 1;
  ridge.taper_m = 6;
  ridge.yaw_rad = std::numbers::pi / 4;
  const std::string feature =
      R"("feature": {"type": "ridge", "length_m": 60, "width_m": 2, "height_m": 1, "yaw_deg": 45})";
  EXPECT_EQ(pattern_of(R"({"type": "lines", "density_per_km2": 50, )" + feature + "}"),
            FeaturePattern(LinePattern{ridge, 5e-5, 60, std::numbers::pi / 2}));
  EXPECT_EQ(
      pattern_of(
          R"({"type": "lines", "density_per_km2": 50, "shortest_m": 20, "yaw_spread_deg": 0, "seed": 3, )" +
          feature + "}"),
      FeaturePattern(LinePattern{ridge, 5e-5, 20, 0, 3}));
  EXPECT_THAT(
      population_refusal(R"({"type": "lines", "density_per_km2": 50, "shortest_m": 70, )" + feature + "}"),
      HasSubstr("c.json: /patterns/0/shortest_m: 70 is not"));
  EXPECT_THAT(population_refusal(R"({"type": "lines", "density_per_km2": 50, "feature": {"type": "pit"}})"),
              HasSubstr("c.json: /patterns/0/feature"));
}

TEST(PopulationConfig, RefusalsNameFilePatternAndKey) {
  const std::pair<const char*, const char*> wrong[] = {
      {R"("golombek_rocks")", "c.json: /patterns/0: give either k or area_fraction"},
      {R"("ice_blocks", "k": 0.1, "area_fraction": 0.1)", "give either"},
      {R"("golombek_rocks", "area_fraction": 0.5, "area_fraction_above_m": 1)",
       "c.json: /patterns/0/area_fraction: rocks of 1 m and more cover at most"},
      {R"("power_law_rocks", "exponent": 2)", "/exponent: is allowed only with model custom, not with viper"},
      {R"("power_law_rocks", "model": "custom", "exponent": 2)",
       "/model: custom needs coefficient and exponent"},
      {R"("craters", "model": "production")", "production needs"},
      {R"("craters", "min_diameter_m": 5, "max_diameter_m": 5)",
       "/max_diameter_m: 5 is not greater than min_diameter_m"},
      {R"("craters", "freshness_min": 0)", "/patterns/0/freshness_min"},
      {R"("craters", "sede": 1)", "seed"}};
  for (const auto& [pattern, words] : wrong)
    EXPECT_THAT(population_refusal(R"({"type": )" + std::string(pattern) + "}"), HasSubstr(words));
}

// Known before anything is drawn, so that --check says it too.
TEST(PopulationConfig, RefusesMoreThanItCanHold) {
  EXPECT_THAT(
      population_refusal(
          R"({"type": "ring", "count": 1, "radius_m": 1, "feature": {"type": "hemisphere", "radius_m": 1}},
                         {"type": "craters", "min_diameter_m": 0.001})"),
      testing::MatchesRegex("c.json: /patterns/1: about 1[0-9]+ craters would be drawn, more than 1e.07.*"));
  EXPECT_THAT(
      population_refusal(R"({"type": "craters", "region": {"type": "disc", "x_m": 100, "radius_m": 10}})"),
      HasSubstr("accepted"));  // they reach in from outside
  EXPECT_THAT(population_refusal(
                  R"({"type": "power_law_rocks", "region": {"type": "disc", "x_m": 100, "radius_m": 10}})"),
              HasSubstr("c.json: /patterns/0/region: does not meet the site"));
}

}  // namespace
}  // namespace landfall
