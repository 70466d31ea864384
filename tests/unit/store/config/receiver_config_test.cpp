// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "chain/lidar/error_models/random_navigation_error.h"
#include "refusal.h"
#include "scan_models.h"
#include "store/config/receiver_config.h"
#include "store/config/scan_components.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Json with_receiver(const std::string& type, const Json& changes = Json::object()) {
  Json config = {{"receiver", {{"type", type}}},
                 {"link", {{"reference_pe", 400}, {"reference_range_m", 500}}}};
  config.merge_patch(changes);
  return completed_scan(config);
}

std::vector<double> constants(const Json& config) {
  return scan_model(config, "scan.json", {}).lidar.link_constants_pe_m2;
}

std::string receiver_refusal(const Json& config) {
  return refusal([&] { return scan_model(config, "scan.json", {}); });
}

TEST(ReceiverConfig, WithoutAReceiverNothingIsSeen) {
  const ScanModel model = scan_model(completed_scan(Json::object()), "scan.json", {});
  EXPECT_FALSE(model.lidar.receiver.uses_waveforms());
  EXPECT_FALSE(model.lidar.range_timer.is_on());
  EXPECT_THAT(model.lidar.link_constants_pe_m2, IsEmpty());
}

TEST(ReceiverConfig, TheDefaultsOfTheSchemaAreNeverWarnedAbout) {
  EXPECT_THAT(receiver_warnings(completed_scan(Json::object())), IsEmpty());
  for (const char* const type : {"leading_edge", "constant_fraction", "peak", "centroid", "geiger"})
    EXPECT_THAT(receiver_warnings(with_receiver(type, {{"detector", {{"subpixels", 2}}}})), IsEmpty())
        << type;
}

TEST(ReceiverConfig, SubRaysShareThePixel) {
  const std::vector<double> one = constants(with_receiver("peak"));
  ASSERT_EQ(one.size(), 18U * 18);
  EXPECT_DOUBLE_EQ(one[0], 400 * 500.0 * 500);
  const std::vector<double> nine =
      constants(with_receiver("peak", {{"detector", {{"subpixels", 3}}}, {"surface", {{"albedo", 0.5}}}}));
  ASSERT_EQ(nine.size(), 9 * one.size());
  EXPECT_DOUBLE_EQ(nine[0], one[0] * 0.5 / 9);
}

TEST(ReceiverConfig, TheBeamWeighsThePixels) {
  const std::vector<double> lit = constants(with_receiver(
      "peak", {{"beam", {{"divergence_rad", 3.2e-3}}}, {"detector", {{"rows", 1}, {"columns", 19}}}}));
  EXPECT_NEAR(lit[9] / (400 * 500.0 * 500), 1, 1e-9);
  const double edge_rad = std::atan(9 * 1.6e-3 / 18);
  EXPECT_NEAR(lit[0] / lit[9], std::exp(-8 * std::pow(edge_rad / 3.2e-3, 2)), 1e-9);
}

TEST(ReceiverConfig, ALinkDesignUsesThePixelsSolidAngle) {
  const Json design = {{"pulse_energy_J", 1e-3}, {"wavelength_m", 1e-6},    {"aperture_m", 0.1},
                       {"efficiency", 0.25},     {"reference_pe", nullptr}, {"reference_range_m", nullptr}};
  const Json beam = {{"divergence_rad", 2e-3}, {"profile", "top_hat"}};
  const double photons = 1e-3 * 1e-6 / (6.62607015e-34 * 299792458);
  const double per_sr = photons * 0.25 * 4 / (std::acos(-1.0) * 4e-6) * 0.01 / 4;
  const Json pitch = {{"rows", 1}, {"columns", 1}, {"ifov_rad", {1e-4, 2e-4}}, {"fill_factor", 0.5}};
  EXPECT_NEAR(constants(with_receiver("peak", {{"link", design}, {"beam", beam}, {"detector", pitch}}))[0] /
                  (per_sr * 1e-8),
              1, 1e-12);
  const Json field = {{"rows", 1}, {"columns", 2}, {"fov_deg", {0.04, 0.02}}};
  const double pixel_sr = std::tan(0.02 * std::acos(-1.0) / 180) * 2 * std::tan(0.01 * std::acos(-1.0) / 180);
  EXPECT_NEAR(constants(with_receiver("peak", {{"link", design}, {"beam", beam}, {"detector", field}}))[0] /
                  (per_sr * pixel_sr),
              1, 1e-12);
}

TEST(ReceiverConfig, SaysWhatIsMissingOrExcluded) {
  const std::pair<Json, const char*> wrong[] = {
      {with_receiver("peak", {{"link", {{"aperture_m", 0.1}}}}), "aperture_m: excludes reference_pe"},
      {with_receiver("peak", {{"detector", {{"estimator", "first"}}}}), "/receiver/type: excludes"},
      {with_receiver("geiger", {{"receiver", {{"dead_time_s", 1e-3}}}}), "/receiver/dead_time_s: is longer"}};
  for (const auto& [config, words] : wrong) EXPECT_THAT(receiver_refusal(config), HasSubstr(words));
}

TEST(ReceiverConfig, WarnsOfKeysWithoutEffect) {
  EXPECT_THAT(receiver_warnings(with_receiver(
                  "peak", {{"receiver", {{"fraction", 0.2}}}, {"detector", {{"subpixels", 2}}}})),
              ElementsAre(HasSubstr("/receiver/fraction has no effect")));
  EXPECT_THAT(
      receiver_warnings(with_receiver("peak", Json::object())),
      ElementsAre(HasSubstr("/detector/subpixels is 1: the receiver peak sees one ray of each pixel")));
  EXPECT_THAT(receiver_warnings(completed_scan({{"surface", {{"albedo", 0.3}}}})),
              ElementsAre(HasSubstr("/surface has no effect")));
  EXPECT_TRUE(uses_albedo_map(with_receiver("peak", {{"surface", {{"albedo", "terrain"}}}})));
  EXPECT_FALSE(uses_albedo_map(completed_scan({{"surface", {{"albedo", "terrain"}}}})));
}

/// For configurations that name no table, but shall be built, not only checked.
const TableLoader kNoTable = [](const std::string&, const std::string&, const TableColumns&) {
  return NumberTable{};
};

std::string refusal_of(const std::string& text) {
  return refusal([&] { return typed_scan(text); });
}

TEST(ErrorConfig, RangeErrorsAreRead) {
  const RangeErrors read =
      typed_scan(R"({"seed": 5, "noise": {"range_sigma_m": 0.03, "range_sigma_per_m": 1e-4,
      "incidence_sigma_rad": 2e-4, "false_return_frac": 0.25, "false_range_m": [20, 30]}})")
          .lidar.range_errors;
  EXPECT_NEAR(read.sigma_m(400, 1.5), 0.13, 1e-16);
  const RangeErrors expected({.false_return_frac = 0.25, .false_min_m = 20, .false_max_m = 30}, 5);
  for (std::int64_t i = 0; i < 100; ++i)
    EXPECT_EQ(read.false_return_m({i, 0}), expected.false_return_m({i, 0}));
}

TEST(ErrorConfig, PointingErrorsAreRead) {
  const PointingError read =
      typed_scan(R"({"seed": 5, "pointing_error": {"misalignment_rpy_rad": [0.1, 0.2, 0.3],
      "jitter_sigma_rad": [0.4, 0.5], "time_stamp_bias_s": 0.6, "time_stamp_sigma_s": 0.7,
      "mirror_time_bias_s": 0.8, "mirror_time_sigma_s": 0.9}})")
          .lidar.pointing_error;
  const PointingError expected({{0.1, 0.2, 0.3}, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}, 5);
  EXPECT_EQ(read.rotation(3), expected.rotation(3));
  EXPECT_EQ(read.time_stamp_error_s(3), expected.time_stamp_error_s(3));
  const PointingError scalar =
      typed_scan(R"({"seed": 5, "pointing_error": {"jitter_sigma_rad": 0.4}})").lidar.pointing_error;
  EXPECT_EQ(scalar.rotation(3), PointingError({{}, 0.4, 0.4, 0, 0}, 5).rotation(3));
  const PointingError slow = typed_scan(R"({"seed": 5, "laser": {"pulse_rate_hz": 1000},
      "pointing_error": {"jitter_sigma_rad": 0.4, "jitter_time_s": 0.01}})")
                                 .lidar.pointing_error;
  EXPECT_EQ(slow.rotation(3), PointingError({.jitter_sigma_x_rad = 0.4,
                                             .jitter_sigma_y_rad = 0.4,
                                             .jitter_time_s = 0.01,
                                             .pulse_interval_s = 1e-3},
                                            5)
                                  .rotation(3));
  EXPECT_FALSE(typed_scan("{}").lidar.pointing_error.turns_beams());
}

TEST(ErrorConfig, RandomNavigationErrorsAreReadAndReachOverTheScanAndItsStamps) {
  const ScanModel model =
      typed_scan(R"({"seed": 5, "laser": {"scan_time_s": 3}, "pointing_error": {"time_stamp_bias_s": 1},
      "navigation_error": {"position_m": [1, 2, 3], "interval_s": 0.5,
        "random_walk": {"position_m_per_sqrt_s": [1, 2, 3], "velocity_mps_per_sqrt_s": [4, 5, 6], "rpy_rad_per_sqrt_s": [0.1, 0.2, 0.3]},
        "gauss_markov": {"position_sigma_m": [7, 8, 9], "position_time_s": 2, "velocity_sigma_mps": [1, 1, 2], "velocity_time_s": 3,
                         "rpy_sigma_rad": [0.3, 0.2, 0.1], "rpy_time_s": 4}}})",
                 kNoTable);
  const RandomNavigationError expected({.position_m = {{1, 2, 3}}},
                                       {{{{1, 2, 3}}, {{4, 5, 6}}, {0.1, 0.2, 0.3}},
                                        {{{7, 8, 9}}, 2, {{1, 1, 2}}, 3, {0.3, 0.2, 0.1}, 4},
                                        0.5},
                                       {5, 4});
  for (const double t : {0.0, 1.7, 4.0})
    EXPECT_EQ(model.navigation_error->estimated({}, t), expected.estimated({}, t)) << t;
}

TEST(ErrorConfig, ATableOfEstimatesIsReadByTheLoader) {
  const std::string config = R"({"navigation_error": {"table": "a.csv"}})";
  EXPECT_EQ(typed_scan(config, two_poses("navigation")).estimate->pose(5).position.v,
            Eigen::Vector3d(2, 3, 4));
  EXPECT_NO_THROW(static_cast<void>(typed_scan(config)));
  EXPECT_EQ(typed_scan("{}").estimate, nullptr);
}

TEST(ErrorConfig, ATableExcludesOtherNavigationErrors) {
  for (const char* const other :
       {R"("position_m": [1, 0, 0])", R"("velocity_mps": [0, 1, 0])", R"("rpy_rad": [0, 0, 1])",
        R"("rpy_rate_radps": [1, 0, 0])", R"("random_walk": {"rpy_rad_per_sqrt_s": [0, 1, 0]})",
        R"("gauss_markov": {"velocity_sigma_mps": [0, 1, 0]})"})
    EXPECT_THAT(refusal_of(R"({"navigation_error": {"table": "a.csv", )" + std::string(other) + "}}"),
                HasSubstr("c.json: /navigation_error/table: excludes "))
        << other;
}

TEST(ErrorConfig, WarnsOfPointingErrorsWithoutEffect) {
  const auto warnings = [](const char* changes) {
    return pointing_warnings(completed_scan(nlohmann::json::parse(changes)));
  };
  EXPECT_THAT(warnings("{}"), testing::IsEmpty());
  EXPECT_THAT(warnings(R"({"pointing_error": {"jitter_time_s": 1}})"),
              testing::ElementsAre(HasSubstr("/pointing_error/jitter_time_s has no effect")));
  EXPECT_THAT(warnings(R"({"pointing_error": {"jitter_time_s": 1, "jitter_sigma_rad": [0, 1e-5],
                                              "mirror_time_bias_s": 1e-5, "mirror_time_sigma_s": 1e-5}})"),
              testing::IsEmpty());
  EXPECT_THAT(warnings(R"({"scanner": {"type": "flash"}, "pointing_error": {"mirror_time_bias_s": -1e-5}})"),
              testing::ElementsAre(HasSubstr("/pointing_error/mirror_time_bias_s has no effect")));
}

TEST(ErrorConfig, RefusalsNameKeyValueAndBound) {
  const std::pair<const char*, const char*> wrong[] = {
      {R"({"noise": {"incidence_sigma_rad": -1}})", "/incidence_sigma_rad: -1 is not in [0, 1]"},
      {R"({"pointing_error": {"jitter_sigma_rad": [1, -2]}})", "/jitter_sigma_rad/1: -2 is not in [0, 1e9]"},
      {R"({"navigation_error": {"gauss_markov": {"position_time_s": 0}}})",
       "/position_time_s: 0 is not in (0, 1e6]"},
      {R"({"pointing_error": {"time_stamp_bias_s": -2e6}})", "_bias_s: -2000000.0 is not in [-1e6, 1e6]"},
      {R"({"pointing_error": {"time_stamp_sigma_s": 2e6}})", "_sigma_s: 2000000.0 is not in [0, 1e6]"}};
  for (const auto& [text, words] : wrong) EXPECT_THAT(refusal_of(text), HasSubstr(words));
  EXPECT_THAT(refusal_of(R"({"pointing_error": {"time_stamp_bias_s": 5e5},
                             "navigation_error": {"random_walk": {"rpy_rad_per_sqrt_s": [0, 1, 0]}}})"),
              HasSubstr("500002 s, the scan and its time-stamp errors"));
}

}  // namespace
}  // namespace landfall
