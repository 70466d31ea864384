// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "chain/lidar/error_models/random_navigation_error.h"
#include "refusal.h"
#include "store/config/json_source.h"
#include "store/config/scan_components.h"
#include "store/config/scan_config.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

ScanModel scan_of(const std::string& text, const TableLoader& load_table = {}) {
  Json config = resolve_config({"c.json", Json::parse(text)}, embedded_schema("scan"));
  complete_scan_config(config);
  return scan_model(config, "c.json", load_table);
}

/// For configurations that name no table, but shall be built, not only checked.
const TableLoader kNoTable = [](const std::string&, const std::string&, const TableColumns&) {
  return NumberTable{};
};

std::string refusal_of(const std::string& text) {
  return refusal([&] { return scan_of(text); });
}

TEST(ErrorConfig, RangeErrorsAreRead) {
  const RangeErrors read = scan_of(R"({"seed": 5, "noise": {"range_sigma_m": 0.03, "range_sigma_per_m": 1e-4,
      "incidence_sigma_rad": 2e-4, "false_return_frac": 0.25, "false_range_m": [20, 30]}})")
                               .lidar.range_errors;
  EXPECT_NEAR(read.sigma_m(400, 1.5), 0.13, 1e-16);
  const RangeErrors expected({.false_return_frac = 0.25, .false_min_m = 20, .false_max_m = 30}, 5);
  for (std::int64_t i = 0; i < 100; ++i)
    EXPECT_EQ(read.false_return_m({i, 0}), expected.false_return_m({i, 0}));
}

TEST(ErrorConfig, PointingErrorsAreRead) {
  const PointingError read =
      scan_of(R"({"seed": 5, "pointing_error": {"misalignment_rpy_rad": [0.1, 0.2, 0.3],
      "jitter_sigma_rad": [0.4, 0.5], "time_stamp_bias_s": 0.6, "time_stamp_sigma_s": 0.7,
      "mirror_time_bias_s": 0.8, "mirror_time_sigma_s": 0.9}})")
          .lidar.pointing_error;
  const PointingError expected({{0.1, 0.2, 0.3}, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}, 5);
  EXPECT_EQ(read.turn(3), expected.turn(3));
  EXPECT_EQ(read.time_stamp_error_s(3), expected.time_stamp_error_s(3));
  const PointingError scalar =
      scan_of(R"({"seed": 5, "pointing_error": {"jitter_sigma_rad": 0.4}})").lidar.pointing_error;
  EXPECT_EQ(scalar.turn(3), PointingError({{}, 0.4, 0.4, 0, 0}, 5).turn(3));
  const PointingError slow = scan_of(R"({"seed": 5, "laser": {"pulse_rate_hz": 1000},
      "pointing_error": {"jitter_sigma_rad": 0.4, "jitter_time_s": 0.01}})")
                                 .lidar.pointing_error;
  EXPECT_EQ(slow.turn(3), PointingError({.jitter_sigma_x_rad = 0.4,
                                         .jitter_sigma_y_rad = 0.4,
                                         .jitter_time_s = 0.01,
                                         .pulse_interval_s = 1e-3},
                                        5)
                              .turn(3));
  EXPECT_FALSE(scan_of("{}").lidar.pointing_error.turns_beams());
}

TEST(ErrorConfig, RandomNavigationErrorsAreReadAndReachOverTheScanAndItsStamps) {
  const ScanModel model =
      scan_of(R"({"seed": 5, "laser": {"scan_time_s": 3}, "pointing_error": {"time_stamp_bias_s": 1},
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
  const auto load = [](const std::string& path, const std::string& role, const TableColumns&) {
    EXPECT_EQ(path + " as " + role, "a.csv as navigation");
    return NumberTable("b.csv", {{"t_s", {0, 5}},
                                 {"x_m", {1, 2}},
                                 {"y_m", {3, 3}},
                                 {"z_m", {4, 4}},
                                 {"qw", {1, 1}},
                                 {"qx", {0, 0}},
                                 {"qy", {0, 0}},
                                 {"qz", {0, 0}}});
  };
  EXPECT_EQ(scan_of(config, load).estimate->pose(5).position.v, Eigen::Vector3d(2, 3, 4));
  EXPECT_NO_THROW(static_cast<void>(scan_of(config)));
  EXPECT_EQ(scan_of("{}").estimate, nullptr);
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
    nlohmann::json config = resolve_config(parse_json(changes, "c.json"), embedded_schema("scan"));
    complete_scan_config(config);
    return pointing_warnings(config);
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
  EXPECT_THAT(refusal_of(R"({"noise": {"false_range_m": [30, 20]}})"),
              AllOf(HasSubstr("c.json: /noise/false_range_m/1: 20"), HasSubstr("greater")));
  EXPECT_THAT(refusal_of(R"({"noise": {"incidence_sigma_rad": -1}})"),
              AllOf(HasSubstr("/noise/incidence_sigma_rad: -1"), HasSubstr("is not in [0, 1]")));
  EXPECT_THAT(refusal_of(R"({"pointing_error": {"jitter_sigma_rad": [1, -2]}})"),
              AllOf(HasSubstr("/pointing_error/jitter_sigma_rad/1: -2"), HasSubstr("is not in [0, 1e9]")));
  EXPECT_THAT(refusal_of(R"({"navigation_error": {"gauss_markov": {"position_time_s": 0}}})"),
              HasSubstr("/navigation_error/gauss_markov/position_time_s: 0 is not in (0, 1e6]"));
  EXPECT_THAT(
      refusal_of(
          R"({"navigation_error": {"interval_s": 1e-9, "random_walk": {"rpy_rad_per_sqrt_s": [0, 1, 0]}}})"),
      HasSubstr("c.json: /navigation_error/interval_s: 1e-09 is not long enough"));
  EXPECT_THAT(refusal_of(R"({"pointing_error": {"time_stamp_bias_s": -2e6}})"),
              HasSubstr("/pointing_error/time_stamp_bias_s: -2000000.0 is not in [-1e6, 1e6]"));
  EXPECT_THAT(refusal_of(R"({"pointing_error": {"time_stamp_sigma_s": 2e6}})"),
              HasSubstr("/pointing_error/time_stamp_sigma_s: 2000000.0 is not in [0, 1e6]"));
  EXPECT_THAT(refusal_of(R"({"pointing_error": {"time_stamp_bias_s": 5e5},
                             "navigation_error": {"random_walk": {"rpy_rad_per_sqrt_s": [0, 1, 0]}}})"),
              HasSubstr("500002 s, the scan and its time-stamp errors"));
}

}  // namespace
}  // namespace landfall
