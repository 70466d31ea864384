// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/receiver_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "refusal.h"
#include "scan_models.h"

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
  EXPECT_FALSE(model.lidar.receiver.sees_waveforms());
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

}  // namespace
}  // namespace landfall
