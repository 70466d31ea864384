// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/uncertainty_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/error.h"
#include "refusal.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

Json resolved(const std::string& text) {
  return resolve_config({"c.json", Json::parse(text)}, embedded_schema("regrid"));
}

ScanOrigin scan(const std::string& name, double range_sigma_m, double velocity_error_mps = 0) {
  return {name, resolve_config(
                    {"s.json", Json{{"noise", {{"range_sigma_m", range_sigma_m}}},
                                    {"navigation_error", {{"velocity_mps", {0, velocity_error_mps, 0}}}}}},
                    embedded_schema("scan"))};
}

std::string refusal_of(const std::string& config, const std::vector<ScanOrigin>& scans) {
  return refusal([&] { return uncertainty_parameters(resolved(config), "c.json", scans); });
}

// Any program may have made the scan.
TEST(UncertaintyConfig, AForeignScanTellsNothing) {
  for (const Json& error : {Json(5), Json("none"), Json::array(), Json(nullptr)}) {
    ScanOrigin foreign = scan("a.h5", 0.02);
    foreign.config["navigation_error"] = error;
    EXPECT_THAT(refusal_of("{}", {foreign}),
                HasSubstr("a.h5 may have a navigation or pointing error of unknown sigma"))
        << error;
  }
}

TEST(UncertaintyConfig, TakesFromTheScansWhatIsNotGiven) {
  const UncertaintyParameters parameters =
      uncertainty_parameters(resolved("{}"), "c.json", {scan("a.h5", 0.02), scan("b.h5", 0.02)});
  EXPECT_EQ(parameters.range_sigma_m, 0.02);
  EXPECT_EQ(parameters.navigation.position_m.v, Eigen::Vector3d::Zero());
  EXPECT_EQ(parameters.navigation.rpy_rate_radps, RollPitchYaw{});
}

TEST(UncertaintyConfig, WhatIsGivenWinsOverTheScans) {
  const UncertaintyParameters parameters = uncertainty_parameters(
      resolved(R"({"uncertainty": {"range_sigma_m": 0.5, "navigation_sigma": {"position_m": [1, 2, 3],
                  "velocity_mps": [4, 5, 6], "rpy_rad": [7, 8, 9], "rpy_rate_radps": [10, 11, 12]}}})"),
      "c.json", {scan("a.h5", 0.02, 0.3), scan("b.h5", 0.03), {"c.h5", nullptr}});
  EXPECT_EQ(parameters.range_sigma_m, 0.5);
  EXPECT_EQ(parameters.navigation.position_m.v, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(parameters.navigation.velocity_mps.v, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(parameters.navigation.rpy_rad, (RollPitchYaw{7, 8, 9}));
  EXPECT_EQ(parameters.navigation.rpy_rate_radps, (RollPitchYaw{10, 11, 12}));
  EXPECT_EQ(uncertainty_json(parameters),
            resolved(R"({"uncertainty": {"range_sigma_m": 0.5, "navigation_sigma":
      {"position_m": [1, 2, 3], "velocity_mps": [4, 5, 6], "rpy_rad": [7, 8, 9],
       "rpy_rate_radps": [10, 11, 12]}}})")["uncertainty"]);
}

TEST(UncertaintyConfig, NavigationKeysLeftOutAre0) {
  const UncertaintyParameters parameters = uncertainty_parameters(
      resolved(R"({"uncertainty": {"navigation_sigma": {"velocity_mps": [1, 1, 1]}}})"), "c.json",
      {scan("a.h5", 0.02, 0.3)});
  EXPECT_EQ(parameters.range_sigma_m, 0.02);
  EXPECT_EQ(parameters.navigation.velocity_mps.v, Eigen::Vector3d::Ones());
  EXPECT_EQ(parameters.navigation.position_m.v, Eigen::Vector3d::Zero());
}

ScanOrigin scan_with(const Json& config) {
  return {"a.h5", resolve_config({"s.json", config}, embedded_schema("scan"))};
}

TEST(UncertaintyConfig, RefusesRangeNoiseThatIsNotTheSameEverywhere) {
  for (const char* const key : {"range_sigma_per_m", "incidence_sigma_rad"}) {
    const ScanOrigin scan = scan_with({{"noise", {{key, 1e-4}}}});
    EXPECT_THAT(refusal_of("{}", {scan}),
                AllOf(HasSubstr("a.h5"), HasSubstr(key), HasSubstr("--range-sigma")));
    EXPECT_EQ(refusal_of(R"({"uncertainty": {"range_sigma_m": 0.1}})", {scan}), "accepted");
  }
}

TEST(UncertaintyConfig, RefusesNavigationAndPointingErrorsWithoutASigma) {
  EXPECT_EQ(refusal_of("{}", {scan_with(Json::object())}), "accepted");
  EXPECT_EQ(refusal_of("{}", {scan_with({{"pointing_error", {{"jitter_sigma_rad", {0, 0}}}}})}), "accepted");
  const std::vector<Json> errors = {
      {{"navigation_error", {{"random_walk", {{"velocity_mps_per_sqrt_s", {0, 1, 0}}}}}}},
      {{"navigation_error", {{"gauss_markov", {{"rpy_sigma_rad", {0, 0, 1}}}}}}},
      {{"navigation_error", {{"table", "a.csv"}}}},
      {{"scanner", {{"type", "fsm"}, {"encoder_sigma_rad", 1e-5}}}},
      {{"pointing_error", {{"misalignment_rpy_rad", {0, 0, 1}}}}},
      {{"pointing_error", {{"jitter_sigma_rad", 1e-5}}}},
      {{"pointing_error", {{"jitter_sigma_rad", {0, 1e-5}}}}},
      {{"pointing_error", {{"time_stamp_bias_s", 1e-3}}}},
      {{"pointing_error", {{"time_stamp_sigma_s", 1e-3}}}}};
  for (const Json& error : errors) {
    EXPECT_THAT(refusal_of("{}", {scan_with(error)}), HasSubstr("--navigation-sigma")) << error;
    EXPECT_EQ(refusal_of(R"({"uncertainty": {"navigation_sigma": {}}})", {scan_with(error)}), "accepted");
  }
}

std::vector<std::string> left_out(const NavigationSigma& sigma, const std::vector<ScanOrigin>& scans) {
  return errors_left_out({.range_sigma_m = 0.01, .navigation = sigma}, scans);
}

TEST(UncertaintyConfig, ListsErrorsThatNoSigmaCovers) {
  using testing::ElementsAre;
  EXPECT_THAT(left_out({}, {scan_with(Json::object()), {"b.h5", nullptr}}), ElementsAre());
  const ScanOrigin systematic = scan_with({{"noise", {{"range_bias_m", -0.01}, {"false_return_frac", 0.1}}},
                                           {"detector", {{"subpixels", 3}, {"estimator", "first"}}},
                                           {"scanner", {{"type", "fsm"}, {"tof_lag", true}}},
                                           {"pointing_error", {{"mirror_time_sigma_s", 1e-6}}}});
  EXPECT_THAT(left_out({}, {systematic, systematic}),
              ElementsAre("/detector/estimator", "/noise/false_return_frac", "/noise/range_bias_m",
                          "/pointing_error/mirror_time_sigma_s", "/scanner/tof_lag"));
  EXPECT_THAT(left_out({}, {scan_with({{"pointing_error", {{"mirror_time_bias_s", -1e-5}}}})}),
              ElementsAre("/pointing_error/mirror_time_bias_s"));
  const auto polygon = [](bool known) {
    Json scanner = Json::parse(R"({"type": "polygon", "facet_tilt_rad": [1e-4], "facet_tilt_sigma_rad": 1e-4,
                                   "encoder_harmonics": [{"order": 1, "amplitude_rad": 1e-5}]})");
    scanner["facet_tilt_known"] = known;
    return scan_with({{"scanner", scanner}});
  };
  EXPECT_THAT(
      left_out({}, {polygon(false)}),
      ElementsAre("/scanner/encoder_harmonics", "/scanner/facet_tilt_rad", "/scanner/facet_tilt_sigma_rad"));
  EXPECT_THAT(left_out({}, {polygon(true)}), ElementsAre("/scanner/encoder_harmonics"));
  // The estimator matters only with sub-pixels.
  EXPECT_THAT(left_out({}, {scan_with({{"detector", {{"estimator", "first"}}}})}), ElementsAre());
  EXPECT_THAT(left_out({}, {scan_with({{"detector", {{"subpixels", 2}}}})}), ElementsAre());
}

TEST(UncertaintyConfig, ListsNavigationErrorsWithASigmaOf0) {
  using testing::ElementsAre;
  const ScanOrigin moved = scan_with(
      {{"navigation_error", {{"position_m", {1, 0, 0}}, {"rpy_rad", {0, 0, 1}}, {"table", "a.csv"}}},
       {"pointing_error", {{"jitter_sigma_rad", 1e-5}}}});
  EXPECT_THAT(left_out({}, {moved}),
              ElementsAre("/navigation_error/position_m", "/navigation_error/rpy_rad",
                          "/navigation_error/table", "/pointing_error/jitter_sigma_rad"));
  // Any sigma may stand for errors that have none of their own.
  EXPECT_THAT(left_out({.rpy_rad = {0, 1e-4, 0}}, {moved}), ElementsAre("/navigation_error/position_m"));
  EXPECT_THAT(left_out({.position_m = {{1, 0, 0}}, .rpy_rad = {0, 1e-4, 0}}, {moved}), ElementsAre());
}

TEST(UncertaintyConfig, NamesJitterThatIsCommonToSomePulses) {
  const auto jittered = [](double sigma_rad) {
    return scan_with({{"pointing_error", {{"jitter_sigma_rad", sigma_rad}, {"jitter_time_s", 1e-3}}}});
  };
  // A sigma of the attitude is common to the whole map, and independent jitter is not correlated.
  EXPECT_THAT(left_out({.rpy_rad = {1e-5, 1e-5, 0}}, {jittered(1e-5)}),
              testing::ElementsAre("/pointing_error/jitter_time_s"));
  EXPECT_THAT(left_out({}, {jittered(0)}), testing::ElementsAre());
}

TEST(UncertaintyConfig, RefusesRangeNoiseThatNobodyTells) {
  EXPECT_THAT(refusal_of("{}", {{"a.h5", nullptr}}), AllOf(HasSubstr("a.h5"), HasSubstr("--range-sigma")));
  EXPECT_THAT(refusal_of("{}", {scan("a.h5", 0.02), scan("b.h5", 0.03)}),
              AllOf(HasSubstr("0.02"), HasSubstr("0.03 m in b.h5"), HasSubstr("--range-sigma")));
}

TEST(UncertaintyConfig, RefusesANavigationErrorWithoutItsSigma) {
  EXPECT_THAT(refusal_of("{}", {scan("a.h5", 0.02), scan("b.h5", 0.02, 0.3)}),
              AllOf(HasSubstr("b.h5"), HasSubstr("--navigation-sigma")));
  EXPECT_THAT(refusal_of(R"({"uncertainty": {"range_sigma_m": 0.1}})", {{"a.h5", nullptr}}),
              AllOf(HasSubstr("a.h5"), HasSubstr("--navigation-sigma")));
}

TEST(UncertaintyConfig, TheSchemaRefusesNegativeSigmas) {
  EXPECT_THAT(refusal([] { resolved(R"({"uncertainty": {"range_sigma_m": -1}})"); }),
              HasSubstr("/uncertainty/range_sigma_m"));
  EXPECT_THAT(refusal([] { resolved(R"({"uncertainty": {"navigation_sigma": {"rpy_rad": [0, -1, 0]}}})"); }),
              HasSubstr("/uncertainty/navigation_sigma/rpy_rad/1"));
  EXPECT_THAT(refusal([] { resolved(R"({"uncertainty": {"navigation_sigma": {"rpy_deg": [0, 1, 0]}}})"); }),
              HasSubstr("rpy_rad"));
}

// The value of an option has not been through the schema.
TEST(UncertaintyConfig, NegativeSigmasOfOptionsAreRefusedByName) {
  Json config = resolved("{}");
  add_navigation_sigma(config, "velocity_mps=1,-2,3");
  EXPECT_THAT(refusal([&] { return uncertainty_parameters(config, "c.json", {scan("a.h5", 0.02)}); }),
              HasSubstr("c.json: /uncertainty/navigation_sigma/velocity_mps: -2"));
}

TEST(NavigationSigmaOption, OneNumberOrThree) {
  Json config = resolved(R"({"uncertainty": {"navigation_sigma": {"rpy_rad": [7, 8, 9]}}})");
  add_navigation_sigma(config, "position_m=0.5");
  add_navigation_sigma(config, "velocity_mps=1,2e-3,0");
  const Json& sigmas = config["uncertainty"]["navigation_sigma"];
  EXPECT_EQ(sigmas["position_m"], Json({0.5, 0.5, 0.5}));
  EXPECT_EQ(sigmas["velocity_mps"], Json({1.0, 2e-3, 0.0}));
  EXPECT_EQ(sigmas["rpy_rad"], Json({7, 8, 9}));
  EXPECT_EQ(sigmas["rpy_rate_radps"], Json({0, 0, 0}));
}

TEST(NavigationSigmaOption, RefusesWhatItCannotRead) {
  const auto refused = [](const std::string& text) {
    return refusal([&] {
      Json config = Json::object();
      add_navigation_sigma(config, text);
    });
  };
  EXPECT_THAT(refused("0.5"), HasSubstr("expected KEY=SIGMA"));
  EXPECT_THAT(refused("position=0.5"), HasSubstr("KEY is position_m"));
  EXPECT_THAT(refused("position_m=0.5x"), HasSubstr("'0.5x' is not a number"));
  EXPECT_THAT(refused("position_m="), HasSubstr("'' is not a number"));
  EXPECT_THAT(refused("position_m=1,2"), HasSubstr("2 numbers; expected 1 or 3"));
  EXPECT_THAT(refused("position_m=1,2,3,4"), HasSubstr("4 numbers"));
}

TEST(UncertaintyConfig, TheTimerAddsToTheRangeNoise) {
  const Json noise = {{"range_sigma_m", 0.03}};
  const auto sigma = [&](const Json& receiver) {
    return uncertainty_parameters(Json::object(), "regrid.json",
                                  {scan_with({{"noise", noise}, {"receiver", receiver}})})
        .range_sigma_m;
  };
  EXPECT_EQ(sigma({{"type", "none"}}), 0.03);
  EXPECT_NEAR(sigma({{"jitter_sigma_s", 0.04 / 149896229}}), 0.05, 1e-15);
  EXPECT_NEAR(sigma({{"timer_step_s", 0.04 * std::sqrt(12.0) / 149896229}}), 0.05, 1e-15);
}

TEST(UncertaintyConfig, ANoiseThatFollowsTheSignalMustBeGiven) {
  const ScanOrigin scan = scan_with({{"noise", {{"range_sigma_m", 0.03}}}, {"receiver", {{"type", "peak"}}}});
  EXPECT_THROW(static_cast<void>(uncertainty_parameters(Json::object(), "regrid.json", {scan})), UsageError);
  const Json given = {{"uncertainty", {{"range_sigma_m", 0.02}}}};
  EXPECT_EQ(uncertainty_parameters(given, "regrid.json", {scan}).range_sigma_m, 0.02);
}

TEST(UncertaintyConfig, NamesTheErrorsOfAReceiver) {
  const ScanOrigin scan =
      scan_with({{"receiver", {{"type", "peak"}, {"pixel_offset_sigma_m", 0.01}, {"clock_scale_ppm", 5}}}});
  EXPECT_THAT(
      errors_left_out({.range_sigma_m = 0.01}, {scan}),
      testing::ElementsAre("/receiver/clock_scale_ppm", "/receiver/pixel_offset_sigma_m", "/receiver/type"));
}

}  // namespace
}  // namespace landfall
