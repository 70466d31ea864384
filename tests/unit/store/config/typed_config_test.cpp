// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/core/error.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/trajectory/dynamics.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "constants.h"
#include "refusal.h"
#include "scan_models.h"
#include "store/config/dem_config.h"
#include "store/config/region_config.h"
#include "store/config/terrain_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

Json typed_config(const std::string& schema, const std::string& text) {
  return resolve_config({"c.json", Json::parse(text)}, embedded_schema(schema));
}

TEST(TerrainConfig, EmptyIsTheDefault) {
  const TerrainConfig config = terrain_config(typed_config("terrain", "{}"), "c.json");
  EXPECT_EQ(config.grid, GridSpec::centered(60, 0.05));
  EXPECT_EQ(config.model.bases, std::vector<Base>{PlaneBase{}});
  EXPECT_TRUE(config.model.features.empty() && config.model.patterns.empty());
  EXPECT_EQ(config.model.seed, TerrainModel{}.seed);
}

TEST(TerrainConfig, MeshReplacesTheGrid) {
  const JsonSource source{
      "c.json", Json::parse(R"({"mesh": {"path": "a/m.stl", "rotate_rpy_deg": [0, 180, 90]}, "seed": 4})")};
  const Json config = resolve_terrain_config(source);
  EXPECT_EQ(config, Json::parse(R"({"mesh": {"path": "a/m.stl", "scale_m": 1, "translate_m": [0, 0, 0],
                                             "rotate_rpy_deg": [0, 180, 90]}})"));
  const TerrainConfig typed = terrain_config(config, "c.json");
  ASSERT_TRUE(typed.mesh);
  EXPECT_EQ(typed.mesh->path, "a/m.stl");
  EXPECT_EQ(typed.mesh->placement.rotate, (RollPitchYaw{0, kPi, kPi / 2}));
  EXPECT_FALSE(terrain_config(resolve_terrain_config({"c.json", Json::object()}), "c.json").mesh);
}

TEST(TerrainConfig, MeshAndGridAreOneTooMany) {
  const auto refused = [](const std::string& text) {
    return refusal([&] { return resolve_terrain_config({"c.json", Json::parse(text)}); });
  };
  for (const std::string key : {"grid", "base", "features", "patterns", "albedo"})
    EXPECT_EQ(refused(R"({"mesh": {"path": "m.obj"}, ")" + key + R"(": {}})"),
              "c.json: /" + key + ": is mutually exclusive with /mesh; remove one");
  EXPECT_THAT(refused(R"({"mesh": {}})"), HasSubstr("/mesh: needs the key \"path\""));
  EXPECT_THAT(refused(R"({"mesh": {"path": "m", "scale_m": 0}})"), HasSubstr("/mesh/scale_m"));
}

TEST(TerrainConfig, Albedo) {
  const auto albedo = [](const std::string& text) {
    return terrain_config(typed_config("terrain", R"({"albedo": )" + text + "}"), "c.json")
        .model.albedo.value();
  };
  EXPECT_FALSE(terrain_config(typed_config("terrain", "{}"), "c.json").model.albedo);
  EXPECT_EQ(albedo("0.3"), AlbedoModel{.ground = 0.3});
  AlbedoModel rocks{.ground = AlbedoGradient{0.1, 0.2, kPi / 2, 7.0}};
  rocks.of_kind[FeatureShape(Rock{}).index()] = 0.05;
  EXPECT_EQ(
      albedo(R"({"ground": {"type": "gradient", "from": 0.1, "to": 0.2, "azimuth_deg": 90, "length_m": 7},
                       "features": {"rock": 0.05}})"),
      rocks);
  EXPECT_EQ(albedo(R"({"ground": {"type": "gradient", "from": 0.1, "to": 0.2}})"),
            (AlbedoModel{.ground = AlbedoGradient{0.1, 0.2}}));
  EXPECT_EQ(albedo(R"({"ground": {"type": "patches", "albedo": 0.9, "albedo_between": 0.2, "cover_frac": 0.3,
                                  "longest_wavelength_m": 8, "hurst_exponent": 0.4}})"),
            (AlbedoModel{.ground = AlbedoPatches{0.9, 0.2, 0.3, 8, 0.4}}));
  AlbedoRaster raster{{}, 0.01, 0.1};
  raster.raster.path = "a.tif";
  raster.raster.band = 3;
  raster.raster.takes_colours = true;
  raster.raster.center_pixel = {4, 5};
  raster.raster.interpolation = Interpolation::nearest;
  raster.raster.horizontal_scale_m = 2;
  EXPECT_EQ(
      albedo(
          R"({"ground": {"type": "raster", "path": "a.tif", "band": 3, "center_pixel": [4, 5], "scale": 0.01,
                                  "offset": 0.1, "interpolation": "nearest", "horizontal_scale_m": 2}})"),
      AlbedoModel{.ground = raster});
}

TEST(TerrainConfig, BaseDefaultsAreThoseOfTheDomain) {
  const TerrainConfig config = terrain_config(
      typed_config("terrain", R"({"base": [{"type": "fractal"}, {"type": "dem", "path": "a.tif"}]})"),
      "c.json");
  DemBase dem;
  dem.path = "a.tif";
  EXPECT_EQ(config.model.bases, (std::vector<Base>{FractalBase{}, dem}));
}

TEST(TerrainConfig, LongestWavelengthIsANumberOrAWord) {
  const auto longest_m = [](const std::string& value) {
    const Json config =
        typed_config("terrain", R"({"base": {"type": "fractal", "longest_wavelength_m": )" + value + "}}");
    return std::get<FractalBase>(terrain_config(config, "c.json").model.bases[0]).longest_wavelength_m;
  };
  EXPECT_EQ(longest_m("25.5"), 25.5);
  EXPECT_EQ(longest_m(R"("none")"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(longest_m(R"("dem")"), std::nullopt);
}

TEST(TerrainConfig, DegreesBecomeRadians) {
  const TerrainConfig config = terrain_config(typed_config("terrain", R"({
      "features": [{"type": "pyramid", "x_m": 1, "y_m": 2, "base_width_m": 3, "height_m": 4, "yaw_deg": 90}],
      "patterns": [{"type": "ring", "count": 3, "radius_m": 5, "first_azimuth_deg": 180,
                    "feature": {"type": "hemisphere", "radius_m": 6}}]})"),
                                              "c.json");
  EXPECT_EQ(config.model.features, (std::vector<Feature>{{1, 2, Pyramid{3, 4, kPi / 2}}}));
  EXPECT_EQ(config.model.patterns, (std::vector<FeaturePattern>{RingPattern{3, 5, kPi, Hemisphere{6}}}));
}

/// The mirror's normal for an aim a little off the boresight.
Eigen::Vector3d mirror_normal(const Scanner& scanner) {
  return scanner.state({.aim = Direction<LidarFrame>::of({{0.05, -0.1, 1}})}).mirror_normal.v;
}

std::vector<Direction<LidarFrame>> pixels_of(const Detector& detector) {
  return {detector.pixels().begin(), detector.pixels().end()};
}

TEST(ScanModel, EmptyIsTheDefault) {
  const ScanModel model = typed_scan("{}");
  EXPECT_EQ(pixels_of(model.lidar.detector), pixels_of(perspective_detector({})));
  EXPECT_EQ(model.pulse_rate_hz, 20000);
  EXPECT_EQ(model.scan_time_s, 2);
  EXPECT_EQ(pulse_count(model), 40000);
  EXPECT_EQ(mirror_normal(*model.lidar.scanner), mirror_normal(Fsm({})));
  EXPECT_EQ(model.lidar.pattern->aim_point({12345, 0}), LineSearch({}).aim_point({12345, 0}));
  EXPECT_EQ(model.trajectory->pose(1.5), ConstantVelocity({}).pose(1.5));
  EXPECT_EQ(model.lidar.range_errors.measured_m(7, {1, 2}), 7);
  EXPECT_EQ(model.navigation_error->estimated(model.trajectory->pose(2), 2), model.trajectory->pose(2));
}

TEST(ScanModel, NominalMountIsDiag1Minus1Minus1) {
  const Eigen::Matrix3d mount = typed_scan("{}").lidar.mount.rotation.m;
  EXPECT_TRUE(mount.isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix(), 1e-15));
}

TEST(ScanModel, DegreesBecomeRadiansAndScalarsHoldForBothAxes) {
  const ScanModel model = typed_scan(R"({"detector": {"fov_deg": 90, "roll_deg": -45},
      "scanner": {"type": "fsm", "incidence_deg": 30, "fold_azimuth_deg": 60, "max_deflection_deg": 20},
      "trajectory": {"type": "constant_velocity", "rpy_deg": [180, 90, 45], "rpy_rate_degps": [0, 0, 18]},
      "navigation_error": {"rpy_rad": [0.1, 0.2, 0.3]}})");
  EXPECT_EQ(pixels_of(model.lidar.detector),
            pixels_of(perspective_detector(
                {.field_of_view = FullFieldOfView{kPi / 2, kPi / 2}, .roll_rad = -45 * kPi / 180})));
  const Fsm expected({kPi / 6, kPi / 3, kPi / 9});
  EXPECT_LT((mirror_normal(*model.lidar.scanner) - mirror_normal(expected)).norm(), 1e-15);
  EXPECT_THROW(
      static_cast<void>(model.lidar.scanner->state({.aim = Direction<LidarFrame>::of({{0, 0.4, 1}})})),
      FormatError);
  const ConstantVelocity motion({.rpy = {kPi, kPi / 2, kPi / 4}, .rpy_rate_radps = {0, 0, kPi / 10}});
  EXPECT_TRUE(model.trajectory->pose(1).rotation.m.isApprox(motion.pose(1).rotation.m, 1e-14));
  const Pose estimate = model.navigation_error->estimated({}, 0);
  EXPECT_EQ(estimate.rotation.m, (rotation_from<DemFrame, BodyFrame>({0.1, 0.2, 0.3}).m));
  EXPECT_EQ(pixels_of(typed_scan(R"({"detector": {"ifov_rad": [0.001, 0.002]}})").lidar.detector),
            pixels_of(perspective_detector({.field_of_view = PixelFieldOfView{0.001, 0.002}})));
}

TEST(ScanModel, DetectorKeysReachTheDetector) {
  const Detector detector =
      typed_scan(
          R"({"detector": {"rows": 1, "columns": 3, "ifov_rad": 0.1, "subpixels": 2, "fill_factor": 0.25,
                  "distortion": {"k1": 1, "k2": 2, "k3": 3}, "estimator": "strongest",
                  "range_resolution_m": 2}})")
          .lidar.detector;
  const Detector expected = perspective_detector({.rows = 1,
                                                  .columns = 3,
                                                  .field_of_view = PixelFieldOfView{0.1, 0.1},
                                                  .subpixels = 2,
                                                  .distortion = {1, 2, 3},
                                                  .fill_factor = 0.25});
  EXPECT_EQ(pixels_of(detector), pixels_of(expected));
  EXPECT_EQ(std::vector(detector.samples().begin(), detector.samples().end()),
            std::vector(expected.samples().begin(), expected.samples().end()));
  std::vector<double> ranges = {10, 20, 21, 22, 23};
  EXPECT_EQ(detector.estimator().range_m(ranges), 21);
}

TEST(ScanModel, EveryEstimatorHasAName) {
  const auto range_of = [](const std::string& name) {
    std::vector<double> ranges = {4, 1, 4, 4.1};
    return typed_scan(R"({"detector": {"estimator": ")" + name + R"("}})")
        .lidar.detector.estimator()
        .range_m(ranges);
  };
  EXPECT_EQ(range_of("mean"), (4 + 1 + 4 + 4.1) / 4);
  EXPECT_EQ(range_of("first"), 1);
  EXPECT_EQ(range_of("median"), 4);
  EXPECT_EQ(range_of("strongest"), (4 + 4 + 4.1) / 3);
}

TEST(ScanModel, ATableOfPixelsIsReadByTheLoader) {
  const std::string config =
      R"({"detector": {"rows": 1, "columns": 2, "distribution": {"path": "p.csv"}, "distortion": {"k1": -1e5}}})";
  const auto load = [](double k1) {
    const auto table = [](const std::string& path, const std::string& role, const TableColumns&) {
      EXPECT_EQ(path + " as " + role, "p.csv as pixels");
      return NumberTable("b.csv",
                         {{"row", {0, 0}}, {"column", {1, 0}}, {"u", {0.5, -0.25}}, {"v", {0, 0.5}}});
    };
    return typed_scan(R"({"detector": {"rows": 1, "columns": 2, "distribution": {"path": "p.csv"},
                       "distortion": {"k1": )" +
                          std::to_string(k1) + "}}}",
                      table);
  };
  EXPECT_EQ(pixels_of(load(0).lidar.detector),
            pixels_of(perspective_detector({.rows = 1, .columns = 2, .points = {{-0.25, 0.5}, {0.5, 0}}})));
  EXPECT_THAT(refusal([&] { return load(-1.5); }),
              HasSubstr("c.json: /detector/distortion: the image folds"));
  // Only checked: nothing is read, and whether the image folds stays open.
  EXPECT_NO_THROW(static_cast<void>(typed_scan(config)));
}

TEST(ScanModel, FlashHasNoPattern) {
  EXPECT_EQ(typed_scan(R"({"scanner": {"type": "flash"}})").lidar.pattern, nullptr);
}

TEST(ScanModel, ATableIsReadByTheLoader) {
  const std::string config = R"({"trajectory": {"type": "table", "path": "a.csv"}})";
  const ScanModel model = typed_scan(config, two_poses("trajectory"));
  EXPECT_EQ(model.trajectory->pose(5).position.v, Eigen::Vector3d(2, 3, 4));
  EXPECT_THAT(refusal<FormatError>([&] { return model.trajectory->pose(6); }),
              HasSubstr("b.csv: trajectory table: time 6"));
  EXPECT_NO_THROW(static_cast<void>(typed_scan(config)));  // only checked: nothing is read
}

TEST(ScanModel, DynamicsTakesEveryKey) {
  const ScanModel model = typed_scan(R"({"laser": {"scan_time_s": 3},
      "trajectory": {"type": "dynamics", "position_m": [1, 2, 300], "velocity_mps": [4, 5, -20],
        "rpy_deg": [0.9, 1.8, 180], "rate_degps": [1.8, 0, -3.6], "gravity_mps2": 1.6, "mass_kg": 700,
        "inertia_kgm2": [100, 110, 120], "inertia_products_kgm2": [5, 6, 7],
        "thrust": {"descent_rate_mps": 19, "gain_per_s": 2, "max_n": 3000},
        "attitude_control": {"command_rpy_deg": [0, 0, 180], "deadband_deg": 0.18, "rate_gain_s": 0.3,
                             "torque_nm": [11, 12, 13]},
        "disturbance": {"torque_nm": [1, 2, 3], "torque_sigma_nm": [4, 5, 6], "seed": 9},
        "control_period_s": 0.02}})");
  DynamicsParameters expected{.body = {.mass_kg = 700},
                              .position_m = {{1, 2, 300}},
                              .velocity_mps = {{4, 5, -20}},
                              .rpy = {0.005 * kPi, 0.01 * kPi, kPi},
                              .rate_radps = {{0.01 * kPi, 0, -0.02 * kPi}},
                              .gravity_mps2 = 1.6,
                              .thrust = {19, 2, 3000},
                              .attitude_control = {{0, 0, kPi}, 0.001 * kPi, 0.3, {11, 12, 13}},
                              .disturbance = {{{1, 2, 3}}, {{4, 5, 6}}, 9},
                              .control_period_s = 0.02,
                              .duration_s = 3};
  expected.body.inertia_kgm2 << 100, 5, 6, 5, 110, 7, 6, 7, 120;
  const DynamicsTrajectory motion(expected);
  EXPECT_EQ(model.trajectory->end_time_s(), motion.end_time_s());
  for (const double t : {0.0, 1.234, 3.0}) {
    EXPECT_LT((model.trajectory->pose(t).position - motion.pose(t).position).norm(), 1e-9);
    EXPECT_LT((model.trajectory->pose(t).rotation.m - motion.pose(t).rotation.m).norm(), 1e-9);
    EXPECT_LT((model.trajectory->nominal_pose(t).position - motion.nominal_pose(t).position).norm(), 1e-9);
  }
}

TEST(ScanModel, DynamicsRefusalsNameFileAndKey) {
  const auto refused = [](const std::string& keys) {
    return refusal([&] { return typed_scan(R"({"trajectory": {"type": "dynamics", )" + keys + "}}"); });
  };
  EXPECT_THAT(refused(R"("mass_kg": 0)"), AllOf(HasSubstr("c.json: /trajectory/mass_kg"), HasSubstr("0")));
  EXPECT_THAT(refused(R"("attitude_control": {"torque_nm": [1, -1, 1]})"),
              HasSubstr("/trajectory/attitude_control/torque_nm/1: -1"));
}

TEST(ScanModel, AttitudeKnowledgeIsAChoice) {
  EXPECT_EQ(typed_scan("{}").attitude_knowledge, AttitudeKnowledge::truth);
  EXPECT_EQ(typed_scan(R"({"navigation_error": {"attitude": "commanded"}})").attitude_knowledge,
            AttitudeKnowledge::commanded);
}

TEST(RegridConfig, EmptyIsTheDefaultAndTheCentroidIsAChoice) {
  const RegridConfig config = regrid_config(typed_config("regrid", "{}"), "c.json");
  EXPECT_EQ(config.grid, GridSpec::centered(50, 0.05));
  EXPECT_EQ(config.grid.cols, 2001);
  EXPECT_EQ(config.truth_at, TruthAt::bin_center);
  EXPECT_EQ(regrid_config(typed_config("regrid", R"({"truth_at": "centroid"})"), "c").truth_at,
            TruthAt::centroid);
}

TEST(EvaluationConfig, EmptyIsTheDefaultAndEveryKeyIsRead) {
  EXPECT_EQ(evaluation_config(typed_config("eval", "{}"), "c.json"), EvaluationParameters{});
  const EvaluationParameters expected{RegionShape::square,      1, {}, 3, 2, FootprintShape::disc, 0.5,
                                      {0.1, 3, 4, 5, 6, 7, 0.8}};
  EXPECT_EQ(evaluation_config(
                typed_config("eval", R"({"region_radius_m": 1, "footprint_m": 2, "footprint_shape": "disc",
      "quantile": 0.5, "region": {"shape": "square", "half_width_m": 3},
      "limits": {"invalid_frac": 0.1, "hole_bins": 3, "distance_bins": 4, "relative_elevation_m": 5,
                 "relative_horizontal_m": 6, "absolute_horizontal_m": 7, "absolute_horizontal_frac": 0.8}})"),
                "c.json"),
            expected);
}

TEST(EvaluationConfig, APolygonHasAFileOrVertices) {
  const Json config = typed_config(
      "eval", R"({"region": {"shape": "polygon", "path": "a", "vertices": [[0, 0], [1, 0], [0, 1]]}})");
  EXPECT_THAT(refusal([&] { return evaluation_config(config, "c.json"); }), HasSubstr("one of the keys"));
}

TEST(RegionConfig, AMaskAPolygonAndACircleOfItsOwnCentre) {
  const auto config = [](const std::string& region) {
    return region_config(typed_config("eval", (R"({"region": )" + region + "}").c_str()), "c.json");
  };
  EXPECT_FALSE(region_config(typed_config("eval", "{}"), "c.json").source);
  const RegionConfig mask = config(R"({"shape": "mask", "path": "a.h5"})");
  EXPECT_EQ(mask.source.value().path, "a.h5");
  EXPECT_EQ(mask.source.value().layer, "mask");
  const RegionConfig polygon = config(R"({"shape": "polygon", "vertices": [[0, 0], [2, 1], [0, 1]]})");
  EXPECT_EQ(polygon.shape, RegionShape::polygon);
  EXPECT_EQ(polygon.source.value().polygons.front().rings().front(), (Polygon::Ring{{0, 0}, {2, 1}, {0, 1}}));
  EXPECT_EQ(config(R"({"shape": "polygon", "path": "a.gpkg", "layer": "b"})").source.value().layer, "b");
  EXPECT_EQ(config(R"({"center_m": [3, -4]})").center_m, (Horizontal{3, -4}));
}

}  // namespace
}  // namespace landfall
