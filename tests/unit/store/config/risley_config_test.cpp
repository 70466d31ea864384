// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "chain/lidar/scanner/risley.h"
#include "constants.h"
#include "refusal.h"
#include "scan_models.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

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
