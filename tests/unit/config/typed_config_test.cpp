// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "base/error.h"
#include "config/dem_config.h"
#include "config/scan_config.h"
#include "config/schema.h"
#include "config/terrain_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

Json resolved(const std::string& schema, const std::string& text) {
  return resolve_config({"c.json", Json::parse(text)}, embedded_schema(schema));
}

ScanConfig scan_of(const std::string& text) { return scan_config(resolved("scan", text), "c.json"); }

template <class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TerrainConfig, EmptyIsTheDefault) {
  const TerrainConfig config = terrain_config(resolved("terrain", "{}"), "c.json");
  EXPECT_EQ(config.grid, GridSpec::centered(60, 0.05));
  EXPECT_EQ(config.model.bases, std::vector<Base>{PlaneBase{}});
  EXPECT_TRUE(config.model.features.empty() && config.model.patterns.empty());
  EXPECT_EQ(config.model.seed, TerrainModel{}.seed);
}

TEST(TerrainConfig, BaseDefaultsAreThoseOfTheDomain) {
  const TerrainConfig config = terrain_config(
      resolved("terrain", R"({"base": [{"type": "fractal"}, {"type": "dem", "path": "a.tif"}]})"), "c.json");
  DemBase dem;
  dem.path = "a.tif";
  EXPECT_EQ(config.model.bases, (std::vector<Base>{FractalBase{}, dem}));
}

TEST(TerrainConfig, DegreesBecomeRadians) {
  const TerrainConfig config = terrain_config(resolved("terrain", R"({
      "features": [{"type": "pyramid", "x_m": 1, "y_m": 2, "base_width_m": 3, "height_m": 4, "yaw_deg": 90}],
      "patterns": [{"type": "ring", "count": 3, "radius_m": 5, "first_azimuth_deg": 180,
                    "feature": {"type": "hemisphere", "radius_m": 6}}]})"),
                                              "c.json");
  EXPECT_EQ(config.model.features, (std::vector<Feature>{{1, 2, Pyramid{3, 4, kPi / 2}}}));
  EXPECT_EQ(config.model.patterns, (std::vector<FeaturePattern>{RingPattern{3, 5, kPi, Hemisphere{6}}}));
}

TEST(TerrainConfig, RefusalsBeginWithTheFile) {
  EXPECT_THAT(refusal([] {
                static_cast<void>(
                    terrain_config(resolved("terrain", R"({"grid": {"resolution_m": 0.7}})"), "c.json"));
              }),
              AllOf(HasSubstr("c.json: /grid"), HasSubstr("half_width_m 60")));
}

TEST(ScanConfig, EmptyIsTheDefault) {
  const ScanConfig config = scan_of("{}");
  EXPECT_EQ(config.detector.rows, PerspectiveParameters{}.rows);
  EXPECT_EQ(config.detector.columns, PerspectiveParameters{}.columns);
  EXPECT_EQ(std::get<PixelFieldOfView>(config.detector.field_of_view).x_rad, PixelFieldOfView{}.x_rad);
  EXPECT_EQ(config.pulse_rate_hz, 20000);
  EXPECT_EQ(config.scan_time_s, 2);
  const auto& fsm = std::get<FsmParameters>(config.scanner);
  EXPECT_EQ(fsm.incidence_rad, FsmParameters{}.incidence_rad);
  EXPECT_DOUBLE_EQ(fsm.max_deflection_rad, FsmParameters{}.max_deflection_rad);
  EXPECT_EQ(config.pattern->rows, LineSearchParameters{}.rows);
  EXPECT_EQ(config.pattern->half_width_m, LineSearchParameters{}.half_width_m);
  EXPECT_EQ(config.pattern->at_end, AtEnd::wrap);
  const auto& trajectory = std::get<ConstantVelocityParameters>(config.trajectory);
  EXPECT_EQ(trajectory.position_m, ConstantVelocityParameters{}.position_m);
  EXPECT_EQ(trajectory.velocity_mps, ConstantVelocityParameters{}.velocity_mps);
  EXPECT_EQ(config.noise.range_sigma_m, 0);
  EXPECT_EQ(config.seed, 1U);
}

TEST(ScanConfig, NominalMountIsDiag1Minus1Minus1) {
  const Eigen::Matrix3d mount = scan_of("{}").mount.rotation.m;
  EXPECT_TRUE(mount.isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix(), 1e-15));
}

TEST(ScanConfig, DegreesBecomeRadiansAndScalarsHoldForBothAxes) {
  const ScanConfig config = scan_of(R"({"detector": {"fov_deg": 90, "roll_deg": -45},
      "scanner": {"type": "fsm", "incidence_deg": 30, "fold_azimuth_deg": 60, "max_deflection_deg": 20},
      "trajectory": {"type": "constant_velocity", "rpy_deg": [180, 90, 45], "rpy_rate_degps": [0, 0, 18]},
      "navigation_error": {"rpy_rad": [0.1, 0.2, 0.3]}})");
  const auto& view = std::get<FullFieldOfView>(config.detector.field_of_view);
  EXPECT_DOUBLE_EQ(view.x_rad, kPi / 2);
  EXPECT_DOUBLE_EQ(view.y_rad, kPi / 2);
  EXPECT_DOUBLE_EQ(config.detector.roll_rad, -kPi / 4);
  const auto& fsm = std::get<FsmParameters>(config.scanner);
  EXPECT_DOUBLE_EQ(fsm.incidence_rad, kPi / 6);
  EXPECT_DOUBLE_EQ(fsm.fold_azimuth_rad, kPi / 3);
  EXPECT_DOUBLE_EQ(fsm.max_deflection_rad, kPi / 9);
  const auto pair = std::get<PixelFieldOfView>(
      scan_of(R"({"detector": {"ifov_rad": [0.001, 0.002]}})").detector.field_of_view);
  EXPECT_EQ(pair.x_rad, 0.001);
  EXPECT_EQ(pair.y_rad, 0.002);
}

TEST(ScanConfig, FlashHasNoPatternAndATableKeepsItsPath) {
  const ScanConfig config =
      scan_of(R"({"scanner": {"type": "flash"}, "trajectory": {"type": "table", "path": "a.csv"}})");
  EXPECT_FALSE(config.pattern.has_value());
  EXPECT_EQ(std::get<TrajectoryFile>(config.trajectory).path, "a.csv");
}

TEST(ScanConfig, BothFieldsOfViewAreRefused) {
  EXPECT_THAT(
      refusal([] { static_cast<void>(scan_of(R"({"detector": {"ifov_rad": 0.001, "fov_deg": 1}})")); }),
      AllOf(HasSubstr("c.json: /detector"), HasSubstr("ifov_rad and fov_deg")));
}

TEST(ScanModel, AScanWithoutAPulseIsRefusedByName) {
  const ScanConfig config = scan_of(R"({"laser": {"pulse_rate_hz": 10, "scan_time_s": 0.05}})");
  EXPECT_THAT(refusal([&] { static_cast<void>(scan_model(config, nullptr, "c.json")); }),
              AllOf(HasSubstr("c.json: "), HasSubstr("pulse_rate_hz x scan_time_s")));
  EXPECT_EQ(pulse_count(scan_model(scan_of("{}"), nullptr, "c.json")), 40000);
}

TEST(RegridConfig, EmptyIsTheDefaultAndTheCentroidIsAChoice) {
  const RegridConfig config = regrid_config(resolved("regrid", "{}"), "c.json");
  EXPECT_EQ(config.grid, GridSpec::centered(50, 0.05));
  EXPECT_EQ(config.grid.cols, 2001);
  EXPECT_EQ(config.truth_at, TruthAt::bin_center);
  EXPECT_EQ(regrid_config(resolved("regrid", R"({"truth_at": "centroid"})"), "c").truth_at,
            TruthAt::centroid);
}

TEST(EvaluationConfig, EmptyIsTheDefaultAndEveryKeyIsRead) {
  EXPECT_EQ(evaluation_config(resolved("eval", "{}"), "c.json"), EvaluationParameters{});
  const EvaluationParameters expected{RegionShape::square,      1, 3, 2, FootprintShape::disc, 0.5,
                                      {0.1, 3, 4, 5, 6, 7, 0.8}};
  EXPECT_EQ(evaluation_config(
                resolved("eval", R"({"region_radius_m": 1, "footprint_m": 2, "footprint_shape": "disc",
      "quantile": 0.5, "region": {"shape": "square", "half_width_m": 3},
      "limits": {"invalid_frac": 0.1, "hole_bins": 3, "distance_bins": 4, "relative_elevation_m": 5,
                 "relative_horizontal_m": 6, "absolute_horizontal_m": 7, "absolute_horizontal_frac": 0.8}})"),
                "c.json"),
            expected);
}

TEST(EvaluationConfig, ARegionHasTheKeysOfItsShape) {
  const auto config = [](const char* text) { return evaluation_config(resolved("eval", text), "c.json"); };
  EXPECT_THAT(refusal([&] { static_cast<void>(config(R"({"region": {"shape": "square"}})")); }),
              AllOf(HasSubstr("c.json: /region"), HasSubstr("half_width_m")));
  EXPECT_THAT(refusal([&] { static_cast<void>(config(R"({"region": {"shape": "mask"}})")); }),
              HasSubstr("path"));
  EXPECT_THAT(refusal([&] { static_cast<void>(config(R"({"region": {"half_width_m": 3}})")); }),
              AllOf(HasSubstr("/region/half_width_m"), HasSubstr("not to circle")));
  EXPECT_FALSE(region_mask_source(resolved("eval", "{}")));
  const auto source =
      region_mask_source(resolved("eval", R"({"region": {"shape": "mask", "path": "a.h5"}})"));
  EXPECT_EQ(source->path, "a.h5");
  EXPECT_EQ(source->layer, "mask");
}

}  // namespace
}  // namespace landfall
