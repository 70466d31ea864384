// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/hazard_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "refusal.h"
#include "store/config/presets.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using testing::HasSubstr;

HazardParameters parameters_of(const std::string& text) {
  return hazard_config(resolve_config({"h.json", nlohmann::json::parse(text)}, embedded_schema("hazard")),
                       "h.json");
}

std::string hazard_refusal(const std::string& text) {
  return landfall::refusal([&] { return parameters_of(text); });
}

void expect_equal_parameters(const HazardParameters& a, const HazardParameters& b) {
  EXPECT_EQ(a.lander.legs, b.lander.legs);
  EXPECT_EQ(a.lander.leg_radius_m, b.lander.leg_radius_m);
  EXPECT_EQ(a.lander.pad_diameter_m, b.lander.pad_diameter_m);
  EXPECT_EQ(a.lander.pad_height, b.lander.pad_height);
  EXPECT_EQ(a.lander.body_radius_m, b.lander.body_radius_m);
  EXPECT_EQ(a.method, b.method);
  EXPECT_EQ(a.region_radius_m, b.region_radius_m);
  EXPECT_EQ(a.limits.slope_deg, b.limits.slope_deg);
  EXPECT_EQ(a.limits.roughness_m, b.limits.roughness_m);
  EXPECT_EQ(a.hole_fill_bins, b.hole_fill_bins);
  EXPECT_EQ(a.z_sigma_m, b.z_sigma_m);
  EXPECT_EQ(a.touchdown_sigma_m, b.touchdown_sigma_m);
  EXPECT_EQ(a.sites.count, b.sites.count);
  EXPECT_EQ(a.sites.separation_m, b.sites.separation_m);
  EXPECT_EQ(a.sites.divert_radius_m, b.sites.divert_radius_m);
  EXPECT_EQ(a.sites.divert_weight, b.sites.divert_weight);
  EXPECT_EQ(a.sites.min_p, b.sites.min_p);
}

TEST(HazardConfig, EmptyIsTheDefault) { expect_equal_parameters(parameters_of("{}"), HazardParameters{}); }

TEST(HazardConfig, EachKeyHasItsMember) {
  const HazardParameters expected{
      .lander = {.legs = 3,
                 .leg_radius_m = 1.5,
                 .pad_diameter_m = 0.4,
                 .pad_height = PadHeight::mean,
                 .body_radius_m = 1.2},
      .method = HazardMethod::plane,
      .region_radius_m = 30,
      .limits = {.slope_deg = 12, .roughness_m = 0.5},
      .hole_fill_bins = 7,
      .z_sigma_m = 0.02,
      .touchdown_sigma_m = 2,
      .sites = {.count = 9, .separation_m = 6, .divert_radius_m = 20, .divert_weight = 0.3, .min_p = 0.9}};
  expect_equal_parameters(
      parameters_of(
          R"({"lander": {"legs": 3, "leg_radius_m": 1.5, "pad_diameter_m": 0.4, "pad_height": "mean",
          "body_radius_m": 1.2}, "method": "plane", "region_radius_m": 30,
          "limits": {"slope_deg": 12, "roughness_m": 0.5}, "hole_fill_bins": 7, "z_sigma_m": 0.02,
          "touchdown_sigma_m": 2, "sites": {"count": 9, "separation_m": 6, "divert_radius_m": 20,
          "divert_weight": 0.3, "min_p": 0.9}})"),
      expected);
}

TEST(HazardConfig, ReachIsACircleAPolygonOrADivert) {
  EXPECT_EQ(parameters_of("{}").sites.reach, std::nullopt);
  EXPECT_TRUE(reachable_area(parameters_of(R"({"sites": {"divert_radius_m": 9}})").sites).contains({0, 9}));
  const auto reach = [](const std::string& text) {
    return reachable_area(parameters_of(R"({"sites": {"divert_radius_m": 1, "reach": )" + text + "}}").sites);
  };
  const ReachableArea triangle = reach("[[10, 0], [20, 0], [10, 10]]");
  EXPECT_TRUE(triangle.contains({12, 3}));
  EXPECT_FALSE(triangle.contains({0, 0}));
  // T = 20 s, b = 3 tan 45 deg: 300 m about (90 + 2 x 5, -20 + 1 x 5) and (90 + 2 x 15, -20 + 1 x 15).
  const ReachableArea divert = reach(
      R"({"height_m": 200, "descent_mps": 20, "velocity_mps": [2, 1], "position_m": [90, -20], "tilt_deg": 45,
          "thrust_accel_mps2": 9, "gravity_mps2": 2})");
  EXPECT_TRUE(divert.contains({120 - 299.9, -5}));
  EXPECT_FALSE(divert.contains({120 - 300.1, -5}));
  EXPECT_TRUE(divert.contains({100 + 299.9, -15}));
  EXPECT_FALSE(divert.contains({100 + 300.1, -15}));
}

TEST(HazardConfig, AReachThatIsWrongIsRefused) {
  const auto refusal = [](const std::string& text) {
    return hazard_refusal(R"({"sites": {"reach": )" + text + "}}");
  };
  EXPECT_THAT(refusal("[[0, 0], [1, 0]]"), HasSubstr("/sites/reach: "));
  EXPECT_THAT(refusal("[[0, 0], [1, 0], [1]]"), HasSubstr("/sites/reach"));
  EXPECT_THAT(refusal("5"), HasSubstr("/sites/reach: 5 is not valid; expected array or object"));
  const auto divert = [&](const std::string& tilt, const std::string& thrust) {
    return refusal(R"({"height_m": 100, "descent_mps": 20, "tilt_deg": )" + tilt +
                   R"(, "gravity_mps2": 1.5, "thrust_accel_mps2": )" + thrust + "}");
  };
  EXPECT_EQ(divert("30", "4"), "accepted");
  EXPECT_THAT(divert("90", "4"), HasSubstr("/sites/reach/tilt_deg: 90 is not in [0, 90)"));
  EXPECT_THAT(divert("30", "3"),
              HasSubstr("h.json: /sites/reach/thrust_accel_mps2: 3 does not stop a descent"));
  EXPECT_THAT(refusal(R"({"height_m": 100})"), HasSubstr("descent_mps"));
}

TEST(HazardConfig, EachMethodHasItsName) {
  const auto method = [](const std::string& name) {
    return parameters_of(R"({"method": ")" + name + "\"}").method;
  };
  EXPECT_EQ(method("contact"), HazardMethod::contact);
  EXPECT_EQ(method("plane"), HazardMethod::plane);
  EXPECT_EQ(method("range_difference"), HazardMethod::range_difference);
  EXPECT_EQ(method("lmeds"), HazardMethod::lmeds);
}

TEST(HazardConfig, AnUnknownSigmaIsNull) {
  EXPECT_EQ(parameters_of(R"({"z_sigma_m": null})").z_sigma_m, std::nullopt);
  EXPECT_THAT(hazard_refusal(R"({"z_sigma_m": 0})"), HasSubstr("h.json: /z_sigma_m: 0 is not in (0, 1000]"));
  EXPECT_THAT(hazard_refusal(R"({"z_sigma_m": "x"})"), HasSubstr("expected number or null"));
}

TEST(HazardConfig, ValuesOutOfBoundsAreRefused) {
  const std::pair<const char*, const char*> wrong[] = {
      {R"({"lander": {"legs": 5}})", "h.json: /lander/legs: 5 is not in [3, 4]"},
      {R"({"lander": {"pad_diameter_m": 0}})", "/lander/pad_diameter_m: 0 is not"},
      {R"({"limits": {"slope_deg": 0}})", "/limits/slope_deg: 0 is not in (0, 90]"},
      {R"({"limits": {"roughness_m": -1}})", "/limits/roughness_m: -1 is not"},
      {R"({"method": "median"})", "/method: \"median\" is not one of"},
      {R"({"region_radius_m": 0})", "/region_radius_m: 0 is not"},
      {R"({"hole_fill_bins": -1})", "/hole_fill_bins: -1 is not"},
      {R"({"sites": {"count": 0}})", "/sites/count: 0 is not"},
      {R"({"sites": {"min_p": 1.1}})", "/sites/min_p: 1.1 is not in [0, 1]"},
      {R"({"slope_deg": 3})", "unknown key"}};
  for (const auto& [text, words] : wrong) EXPECT_THAT(hazard_refusal(text), HasSubstr(words));
}

// The first preset states the defaults, the second is the one of NASA JPL's competition.
TEST(HazardConfig, Presets) {
  const auto preset = [](const std::string& name) {
    return hazard_config(
        resolve_config(read_config({"preset:" + name}, "hazard"), embedded_schema("hazard")));
  };
  expect_equal_parameters(preset("paper-footprint"), HazardParameters{});
  HazardParameters jpl;
  jpl.lander = {.legs = 4,
                .leg_radius_m = 1.7,
                .pad_diameter_m = 0.5,
                .pad_height = PadHeight::mean,
                .body_radius_m = 1.7};
  jpl.limits = {.slope_deg = 10, .roughness_m = 0.353};
  expect_equal_parameters(preset("jpl-2015"), jpl);
  HazardParameters alhat;
  alhat.limits.slope_deg = 5;
  expect_equal_parameters(preset("alhat"), alhat);
  HazardParameters viking;
  viking.lander.legs = 3;
  viking.lander.pad_diameter_m = 0.3;
  viking.lander.leg_radius_m = viking.lander.body_radius_m = 1.276;
  EXPECT_NEAR(viking.lander.leg_radius_m, 2.21 / std::sqrt(3), 1e-4);
  viking.limits = {.slope_deg = 19, .roughness_m = 0.22};
  expect_equal_parameters(preset("viking"), viking);
}

}  // namespace
}  // namespace landfall
