// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>

#include "base/core/error.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/gimbal.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/scanner/polygon.h"
#include "chain/lidar/scanner/risley.h"
#include "constants.h"
#include "refusal.h"
#include "scan_models.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// The keys of errors and limits of the mechanisms.
ScanModel scanner_model(const std::string& scanner) {
  const nlohmann::json given{{"seed", 5}, {"scanner", nlohmann::json::parse(scanner)}};
  return scan_model(completed_scan(given), "c.json", {});
}

std::string scanner_refusal(const std::string& scanner) {
  return refusal([&] { return scanner_model(scanner); });
}

/// The tilts that the lander believes at a late pulse, and whether it is blanked after a long jump.
void expect_equal_scanner(const Scanner& a, const Scanner& b) {
  const auto aim = Direction<LidarFrame>::of({{0.05, -0.1, 1}});
  const auto other = Direction<LidarFrame>::of({{-0.05, 0.1, 1}});
  const PulseContext pulse{.time = {77, 0.385},
                           .aim = aim,
                           .since_jump_s = 0.004,
                           .jump_aims = JumpAims{other, other, aim, aim, 1e-4}};
  const ScannerState x = a.state(pulse);
  const ScannerState y = b.state(pulse);
  EXPECT_EQ(x.mirror_normal, y.mirror_normal);
  EXPECT_EQ(x.blanked, y.blanked);
  EXPECT_EQ(a.is_known(), b.is_known());
  EXPECT_EQ(a.estimated_state(pulse, x).angle_1_rad, b.estimated_state(pulse, y).angle_1_rad);
  EXPECT_EQ(a.estimated_state(pulse, x).angle_2_rad, b.estimated_state(pulse, y).angle_2_rad);
  EXPECT_EQ(a.estimated_state(pulse, x).mirror_normal, b.estimated_state(pulse, y).mirror_normal);
}

const std::vector<EncoderHarmonic> kHarmonics = {
    {.order = 3, .amplitude_rad = 1e-3},
    {.axis = 2, .order = 7, .amplitude_rad = 2e-3, .phase_rad = std::numbers::pi / 180 * 30}};
constexpr const char* kHarmonicsText = R"("encoder_harmonics": [{"order": 3, "amplitude_rad": 1e-3},
    {"axis": 2, "order": 7, "amplitude_rad": 2e-3, "phase_deg": 30}])";

TEST(ScannerConfig, MechanismsAreRead) {
  const MechanismTimingParameters fast{.max_acceleration_radps2 = 2e4};
  const MechanismTimingParameters slow{.max_acceleration_radps2 = 2e3};
  const std::string more = std::string(", ") + kHarmonicsText + "}";
  expect_equal_scanner(
      *scanner_model(R"({"type": "fsm", "max_acceleration_radps2": 2e4)" + more).lidar.scanner,
      Fsm({.encoder_harmonics = kHarmonics, .timing = fast, .seed = 5}));
  expect_equal_scanner(
      *scanner_model(R"({"type": "fsm", "max_acceleration_radps2": 2e3)" + more).lidar.scanner,
      Fsm({.encoder_harmonics = kHarmonics, .timing = slow, .seed = 5}));
  expect_equal_scanner(
      *scanner_model(R"({"type": "gimbal", "max_acceleration_radps2": 2e3)" + more).lidar.scanner,
      Gimbal({.timing = slow, .encoder_harmonics = kHarmonics}));
  expect_equal_scanner(
      *scanner_model(
           R"({"type": "polygon", "facets": 6, "facet_tilt_rad": [1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3],
                             "facet_tilt_sigma_rad": 1e-3, "facet_tilt_known": true)" +
           more)
           .lidar.scanner,
      PolygonScanner({.facets = 6,
                      .facet_tilt_rad = {1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3},
                      .facet_tilt_sigma_rad = 1e-3,
                      .facet_tilt_known = true,
                      .encoder_harmonics = kHarmonics,
                      .seed = 5}));
}

TEST(ScannerConfig, RefusalsNameTheKey) {
  EXPECT_EQ(scanner_refusal(R"({"type": "polygon", "facet_tilt_rad": []})"), "accepted");
  const std::string harmonic = R"("encoder_harmonics": [{"order": )";
  const std::pair<std::string, const char*> wrong[] = {
      {R"("polygon", "facets": 8, "facet_tilt_rad": [0, 0])",
       "/facet_tilt_rad: 2 is not the number of facets"},
      {R"("polygon", "facet_tilt_rad": [0.2])", "/facet_tilt_rad/0: 0.2"},
      {R"("polygon", "facet_tilt_sigma_rad": 0.1)", "/facet_tilt_sigma_rad: 0.1"},
      {R"("fsm", "max_acceleration_radps2": -1)", "/max_acceleration_radps2: -1"},
      {R"("fsm", )" + harmonic + R"(0, "amplitude_rad": 0}])", "/encoder_harmonics/0/order: 0"},
      {R"("fsm", )" + harmonic + "1}]", "amplitude_rad"},
      {R"("gimbal", )" + harmonic + R"(1, "axis": 3, "amplitude_rad": 0}])", "/encoder_harmonics/0/axis: 3"}};
  for (const auto& [scanner, words] : wrong)
    EXPECT_THAT(scanner_refusal(R"({"type": )" + scanner + "}"), HasSubstr(words));
}

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
    EXPECT_EQ(pattern.aim_point(pulse), expected.aim_point(pulse)) << config << ", pulse " << k;
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
        .lidar.pattern->aim_point({0, t_s});
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

Json completed(const std::string& scanner) { return completed_scan({{"scanner", Json::parse(scanner)}}); }

ScanModel risley_model(const std::string& scanner) { return scan_model(completed(scanner), "c.json", {}); }

std::string risley_refusal(const std::string& keys) {
  return refusal([&] { return risley_model(R"({"type": "risley", )" + keys + "}"); });
}

struct Answer {
  ScannerState state;
  Beam beam;
};

/// The beam of a scanner for an oblique pixel of a late pulse and an aim within reach.
Answer answer(const Scanner& scanner) {
  const PulseContext pulse{.time = {77, 0.385}, .aim = Direction<LidarFrame>::of({{0.05, -0.1, 1}})};
  const std::array<Direction<LidarFrame>, 1> pixels{Direction<LidarFrame>::of({{0.02, 0.01, 1}})};
  std::array<Beam, 1> beams;
  Answer result{.state = scanner.state(pulse), .beam = {}};
  scanner.steer(result.state, pixels, beams);
  result.beam = beams[0];
  return result;
}

void expect_equal_risley(const Scanner& a, const Scanner& b) {
  const Answer x = answer(a);
  const Answer y = answer(b);
  EXPECT_EQ(x.state.angle_1_rad, y.state.angle_1_rad);
  EXPECT_EQ(x.state.angle_2_rad, y.state.angle_2_rad);
  EXPECT_EQ(x.beam.direction, y.beam.direction);
  EXPECT_EQ(x.beam.exit, y.beam.exit);
}

TEST(RisleyConfig, DefaultsAreThoseOfTheDomain) {
  const ScanModel model = risley_model(R"({"type": "risley"})");
  expect_equal_risley(*model.lidar.scanner, Risley({}));
  EXPECT_EQ(model.lidar.pattern, nullptr);
  EXPECT_TRUE(model.lidar.scanner->is_known());
}

TEST(RisleyConfig, EveryKeyIsRead) {
  const ScanModel model = risley_model(R"({"type": "risley", "index": [1.4, 1.6], "wedge_deg": [7, 8],
      "thickness_m": [0.01, 0.02], "gap_m": 0.003, "configuration": "PTPT", "rates_hz": [3, 4],
      "phases_deg": [30, 60], "encoder_sigma_rad": 0.01})");
  const Risley expected({.optics = {.prisms = {{{1.4, 7 * kDegree, 0.01}, {1.6, 8 * kDegree, 0.02}}},
                                    .gap_m = 0.003,
                                    .configuration = RisleyConfiguration::ptpt},
                         .drive = RisleyRotation{{3, 4}, {30 * kDegree, 60 * kDegree}},
                         .encoder_sigma_rad = 0.01});
  expect_equal_risley(*model.lidar.scanner, expected);
  EXPECT_FALSE(model.lidar.scanner->is_known());
}

TEST(RisleyConfig, EveryConfigurationHasItsName) {
  using enum RisleyConfiguration;
  const std::pair<const char*, RisleyConfiguration> names[] = {
      {"PTTP", pttp}, {"TPPT", tppt}, {"PTPT", ptpt}, {"TPTP", tptp}};
  for (const auto& [name, configuration] : names)
    expect_equal_risley(
        *risley_model(std::string(R"({"type": "risley", "configuration": ")") + name + "\"}").lidar.scanner,
        Risley({.optics = {.configuration = configuration}}));
}

TEST(RisleyConfig, WithAPatternTheBeamFollowsIt) {
  const std::string pattern = R"({"type": "risley", "pattern": {"type": "line_search"})";
  const ScanModel model = risley_model(pattern + "}");
  EXPECT_NE(model.lidar.pattern, nullptr);
  expect_equal_risley(*model.lidar.scanner, Risley({.drive = RisleyBranch::positive}));
  expect_equal_risley(*risley_model(pattern + R"(, "branch": "negative"})").lidar.scanner,
                      Risley({.drive = RisleyBranch::negative}));
}

TEST(RisleyConfig, TheResolvedConfigurationNamesTheDefaultsInForce) {
  EXPECT_EQ(completed(R"({"type": "risley"})").at("scanner").at("rates_hz"), Json({100, -61.8}));
  const Json steered = completed(R"({"type": "risley", "pattern": {"type": "line_search"}})").at("scanner");
  EXPECT_EQ(steered.at("branch"), "positive");
  EXPECT_FALSE(steered.contains("rates_hz"));
}

TEST(RisleyConfig, RotationAndPatternExcludeEachOther) {
  EXPECT_THAT(risley_refusal(R"("phases_deg": [1, 2], "pattern": {"type": "line_search"})"),
              HasSubstr("c.json: /scanner/phases_deg: excludes pattern; give one of them"));
}

TEST(RisleyConfig, ValuesOutOfRangeAreRefusedByKey) {
  const std::pair<const char*, const char*> wrong[] = {
      {R"("index": 1)", "c.json: /scanner/index: 1"},
      {R"("index": [1.5, 11])", "c.json: /scanner/index/1: 11"},
      {R"("wedge_deg": 90)", "c.json: /scanner/wedge_deg: 90"},
      {R"("wedge_deg": [-1, 3])", "c.json: /scanner/wedge_deg/0: -1"},
      {R"("thickness_m": 0)", "c.json: /scanner/thickness_m: 0"},
      {R"("gap_m": -0.1)", "c.json: /scanner/gap_m: -0.1"},
      {R"("configuration": "PPTT")", "c.json: /scanner/configuration: \"PPTT\""},
      {R"("rates_hz": [1])", "c.json: /scanner/rates_hz"},
      {R"("rates_hz": [1, 2e6])", "c.json: /scanner/rates_hz/1: 2000000"},
      {R"("encoder_sigma_rad": -1)", "c.json: /scanner/encoder_sigma_rad: -1"},
      {R"("wedge": 8)", "c.json: /scanner/wedge"}};
  for (const auto& [key, text] : wrong) EXPECT_THAT(risley_refusal(key), HasSubstr(text));
}

}  // namespace
}  // namespace landfall
