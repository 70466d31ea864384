// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of errors and limits of the mechanisms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/gimbal.h"
#include "chain/lidar/scanner/polygon.h"
#include "refusal.h"
#include "scan_models.h"

namespace landfall {
namespace {

using testing::HasSubstr;

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
  EXPECT_EQ(a.believed_state(pulse, x).angle_1_rad, b.believed_state(pulse, y).angle_1_rad);
  EXPECT_EQ(a.believed_state(pulse, x).angle_2_rad, b.believed_state(pulse, y).angle_2_rad);
  EXPECT_EQ(a.believed_state(pulse, x).mirror_normal, b.believed_state(pulse, y).mirror_normal);
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

}  // namespace
}  // namespace landfall
