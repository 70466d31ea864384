// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "base/core/error.h"
#include "chain/lidar/scanner/patterns.h"
#include "constants.h"
#include "refusal.h"
#include "scan_models.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

/// The scan of a pattern, all else being the default.
Json pattern_scan_config(const std::string& pattern) {
  const std::string text =
      R"({"laser": {"scan_time_s": 3}, "scanner": {"type": "fsm", "pattern": )" + pattern;
  return completed_scan(Json::parse(text + "}}"));
}

ScanModel pattern_model(const std::string& pattern, const TableLoader& load_table = {}) {
  return scan_model(pattern_scan_config(pattern), "c.json", load_table);
}

std::string pattern_refusal(const std::string& pattern) {
  return refusal([&] { return pattern_model(pattern); });
}

void expect_same(const std::string& config, const Pattern& expected) {
  const ScanModel model = pattern_model(config);
  const Pattern& pattern = *model.lidar.pattern;
  EXPECT_EQ(pattern.compensated(), expected.compensated()) << config;
  EXPECT_EQ(pattern.pulse_limit(), expected.pulse_limit()) << config;
  for (const int k : {0, 1, 7, 100, 1999, 39999}) {
    const PulseTime pulse{k, k / 20000.0};
    EXPECT_EQ(pattern.ground_aim(pulse), expected.ground_aim(pulse)) << config << ", pulse " << k;
  }
}

TEST(PatternConfig, DefaultsAreThoseOfTheDomain) {
  expect_same(R"({"type": "line_search"})", LineSearch({}));
  expect_same(R"({"type": "spiral"})", Spiral({.period_s = 3}));  // the scan time
  expect_same(R"({"type": "rosette"})", Rosette({}));
  expect_same(R"({"type": "lissajous"})", Lissajous({}));
  expect_same(R"({"type": "stare"})", Stare({}));
  expect_same(R"({"type": "step_stare"})", StepStare({}));
}

TEST(PatternConfig, EveryKeyIsRead) {
  expect_same(R"({"type": "line_search", "rows": 5, "columns": 7, "half_width_m": 3, "ramped": true,
                  "direction": "boustrophedon", "compensated": false, "at_end": "stop"})",
              LineSearch({5, 7, 3, LineDirection::boustrophedon, false, AtEnd::stop, true}));
  expect_same(R"({"type": "spiral", "radius_m": 9, "pitch_m": 2, "inner_radius_m": 1, "period_s": 0.7,
                  "direction": "inward", "compensated": false})",
              Spiral({9, 2, 1, 0.7, SpiralDirection::inward, false}));
  expect_same(R"({"type": "rosette", "radius_m": 9, "rates_hz": [3, -4], "phases_deg": [30, 60],
                  "compensated": false})",
              Rosette({9, {3, -4}, {30 * kDegree, 60 * kDegree}, false}));
  expect_same(R"({"type": "lissajous", "half_width_m": [4, 5], "rates_hz": [3, 4], "phase_deg": 30,
                  "compensated": false})",
              Lissajous({{4, 5}, {3, 4}, 30 * kDegree, false}));
  expect_same(R"({"type": "lissajous", "half_width_m": 4})", Lissajous({.half_width_m = {4, 4}}));
  expect_same(R"({"type": "stare", "aim_m": [4, -5], "compensated": false})", Stare({{4, -5}, false}));
  expect_same(R"({"type": "step_stare", "rows": 3, "columns": 4, "half_width_m": 6, "pulses_per_step": 5,
                  "direction": "unidirectional", "compensated": false, "at_end": "stop"})",
              StepStare({3, 4, 6, 5, LineDirection::unidirectional, false, AtEnd::stop}));
}

TEST(PatternConfig, TheSpiralsPeriodIsStated) {
  EXPECT_EQ(pattern_scan_config(R"({"type": "spiral"})")["scanner"]["pattern"]["period_s"], 3);
  EXPECT_EQ(pattern_scan_config(R"({"type": "spiral", "period_s": 1})")["scanner"]["pattern"]["period_s"], 1);
}

TEST(PatternConfig, ATableIsReadByTheLoader) {
  const auto load = [](const std::string& path, const std::string& role, const TableColumns&) {
    EXPECT_EQ(path + " as " + role, "a.csv as pattern");
    return NumberTable("b.csv", {{"t_s", {0, 1}}, {"x_m", {2, 4}}, {"y_m", {5, 5}}});
  };
  const auto aim = [&](const std::string& at_end, double t_s) {
    return pattern_model(R"({"type": "table", "path": "a.csv", "at_end": ")" + at_end + "\"}", load)
        .lidar.pattern->ground_aim({0, t_s});
  };
  EXPECT_EQ(aim("stop", 0.5)->v, Eigen::Vector3d(3, 5, 0));
  EXPECT_FALSE(aim("stop", 1.5).has_value());
  EXPECT_EQ(aim("hold", 1.5)->v, Eigen::Vector3d(4, 5, 0));
  EXPECT_THAT(refusal<FormatError>([&] { return aim("wrap", 0); }),
              HasSubstr("b.csv: pattern table: row 2: ends 2 m from the first row"));
  EXPECT_EQ(pattern_refusal(R"({"type": "table", "path": "a.csv"})"),
            "accepted");  // only checked: nothing is read
}

TEST(PatternConfig, RefusalsNameFileKeyValueAndBound) {
  const auto refuses = [](const char* pattern, const char* key, const char* value, const char* bound) {
    EXPECT_THAT(pattern_refusal(pattern), AllOf(HasSubstr("c.json: /scanner/pattern" + std::string(key)),
                                                HasSubstr(value), HasSubstr(bound)))
        << pattern;
  };
  refuses(R"({"type": "spiral", "pitch_m": -1})", "/pitch_m", "-1", "0");
  refuses(R"({"type": "spiral", "radius_m": 5, "inner_radius_m": 7})", "/inner_radius_m", "7",
          "below radius_m");
  refuses(R"({"type": "spiral", "period_s": 0})", "/period_s", "0", "0");
  refuses(R"({"type": "spiral", "direction": "up"})", "/direction", "up", "outward");
  refuses(R"({"type": "rosette", "radius_m": 0})", "/radius_m", "0", "0");
  refuses(R"({"type": "rosette", "rates_hz": 5})", "/rates_hz", "5", "array");
  refuses(R"({"type": "rosette", "phases_deg": [1, 2, 3]})", "/phases_deg", "3", "2");
  refuses(R"({"type": "lissajous", "half_width_m": [3, -2]})", "/half_width_m", "-2", "0");
  refuses(R"({"type": "lissajous", "rates_hz": [3, -2]})", "/rates_hz", "-2", "0");
  refuses(R"({"type": "stare", "aim_m": [3]})", "/aim_m", "1", "2");
  refuses(R"({"type": "step_stare", "pulses_per_step": 0})", "/pulses_per_step", "0", "1");
  refuses(R"({"type": "step_stare", "at_end": "hold"})", "/at_end", "hold", "wrap");
  refuses(R"({"type": "line_search", "ramped": 1})", "/ramped", "1", "boolean");
  refuses(R"({"type": "line_search", "half_width_m": 0})", "/half_width_m", "0", "is not in (0, 1e9]");
  for (const char* const key : {"rows", "columns"})
    for (const char* const type : {"line_search", "step_stare"}) {
      const std::string pattern = R"({"type": ")" + std::string(type) + R"(", ")" + key + "\": ";
      EXPECT_EQ(pattern_refusal(pattern + "1048576}"), "accepted");
      refuses((pattern + "1048577}").c_str(), "", key, "is not in [");
    }
  refuses(R"({"type": "table"})", "", "path", "needs the key");
  refuses(R"({"type": "spirall"})", "/type", "spirall", "step_stare");
}

}  // namespace
}  // namespace landfall
