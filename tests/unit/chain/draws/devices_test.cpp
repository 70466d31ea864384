// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "bins.h"
#include "chain/draws/device_gridder.h"
#include "chain/draws/device_judge.h"
#include "chain/draws/draw_gridder.h"
#include "chain/draws/draw_runner.h"
#include "chain/opencl/devices.h"
#include "device_scan.h"
#include "no_opencl.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;

OpenClDevice device_of(const char* name, const char* kind, const char* problem = "") {
  return {.name = name, .kind = kind, .has_doubles = true, .problem = problem};
}

TEST(OpenClDeviceChoice, PrefersTheFirstUsableGpu) {
  EXPECT_EQ(default_device({device_of("a", "cpu")}), 0U);
  EXPECT_EQ(default_device({device_of("a", "cpu"), device_of("b", "accelerator")}), 1U);
  EXPECT_EQ(default_device({device_of("a", "accelerator"), device_of("b", "gpu", "has no double precision"),
                            device_of("c", "gpu", "rounds a division"), device_of("d", "gpu"),
                            device_of("e", "gpu")}),
            3U);
  EXPECT_EQ(default_device({device_of("a", "gpu", "has no double precision"), device_of("b", "cpu")}), 1U);
}

std::string refusal_of_devices(const std::vector<OpenClDevice>& devices) {
  return refusal<DeviceError>([&] { return default_device(devices); });
}

TEST(OpenClDeviceChoice, SaysWhyThereIsNone) {
  EXPECT_EQ(refusal_of_devices({}), "OpenCL: there is no device, or no driver of it is installed");
  EXPECT_EQ(refusal_of_devices({device_of("a", "gpu", "has no double precision")}),
            "OpenCL: no device can be used: a has no double precision");
  EXPECT_EQ(refusal_of_devices({device_of("a", "gpu", "has no double precision"),
                                device_of("b", "cpu", "rounds a division")}),
            "OpenCL: no device can be used: a has no double precision, and b rounds a division");
}

TEST(OpenClDeviceUse, CountsAndKeepsTheFirstFailure) {
  DeviceUse use;
  use.count_draw();
  use.count_draw();
  use.name_device("d");
  EXPECT_FALSE(use.failure());
  use.fell_back("first");
  use.fell_back("second");
  EXPECT_EQ(use.draws(), 2U);
  EXPECT_EQ(use.device(), "d");
  EXPECT_EQ(use.failure(), "first");
}

TEST(OpenClDeviceChoice, ChosenDeviceMustExist) {
  if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
  EXPECT_THROW(static_cast<void>(usable_device(1000)), UsageError);
}

// Verdicts and maps of an OpenCL device against those of the CPU, to the last bit. The device is pocl's, the
// CPU, unless the machine has another one.
EvaluationParameters rule(const EvaluationLimits& limits, double footprint_m = 1.7) {
  EvaluationParameters parameters;
  parameters.region_radius_m = 4;
  parameters.footprint_m = footprint_m;
  parameters.limits = limits;
  return parameters;
}

/// A draw; its numbers follow from the seed.
struct Draw {
  RangeErrorParameters errors{};
  std::uint64_t seed = 1;
  Method method = Method::bilinear_nearest;
  TruthAt truth_at = TruthAt::bin_center;
  EvaluationParameters evaluation = rule({});

  [[nodiscard]] DrawSetup setup() const { return {device_scan(errors, seed), method, truth_at, evaluation}; }
};

/// Rough ground about kPlane with holes.
TriangulatedGrid rough_terrain() {
  Grid<double> nodes({0.13, -70, -60, 141, 125});
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 0.02);
  for (const auto [row, col] : bins_of(nodes.spec()))
    nodes.at({row, col}) = random() % 200 == 0 ? std::nan("")
                                               : kPlane.z0_m + kPlane.slope_x * nodes.spec().x(col) +
                                                     kPlane.slope_y * nodes.spec().y(row) + normal(random);
  return TriangulatedGrid(std::move(nodes));
}

DrawnDem drawn(DrawGridder& gridder, const Simulation& simulation, Method method, TruthAt truth_at,
               const TerrainSurface& terrain) {
  DrawnDem dem;
  gridder.draw(simulation, method, truth_at, terrain, dem);
  return dem;
}

/// A run of draws with and without a device.
class DeviceJudging : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
    ranges_ = device_scan_ranges();
    start(true);
  }

  void start(bool has_maps) {
    const BinMask region = circular_region(kGrid, 4);
    cpu_.reset();
    device_.reset();
    scene_ = {{ranges_}, &terrain_, kGrid, region};
    if (has_maps) scene_ = with_maps(std::move(scene_));
    cpu_ = std::make_unique<DrawRunner>(scene_);
    device_ = std::make_unique<DrawRunner>(scene_, OpenClOptions{.use = use_});
    expected_ = has_maps ? std::optional(DrawMaps(kGrid)) : std::nullopt;
    found_ = expected_;
  }

  /// Runs a draw on both. Returns whether the device judged it, and keeps it for the maps.
  bool expect_same_metrics(const Draw& draw) {
    const DrawResult expected = run(*cpu_, draw, expected_);
    const DrawResult found = run(*device_, draw, found_);
    const auto& a = std::get<DecisiveMetrics>(expected.metrics);
    const auto& b = std::get<DecisiveMetrics>(found.metrics);
    EXPECT_EQ(b.pass, a.pass);
    EXPECT_EQ(b.coverage, a.coverage);
    EXPECT_EQ(b.requirements, a.requirements);
    EXPECT_EQ(b.accuracy->absolute.horizontal.within_limit_frac,
              a.accuracy->absolute.horizontal.within_limit_frac);
    EXPECT_EQ(b.accuracy->relative.x.violation_count, a.accuracy->relative.x.violation_count);
    EXPECT_EQ(b.accuracy->relative.y.violation_count, a.accuracy->relative.y.violation_count);
    EXPECT_EQ(b.accuracy->relative.z.violation_count, a.accuracy->relative.z.violation_count);
    kept_ += found.is_on_device ? 1 : 0;
    for (const auto& axis : {a.accuracy->relative.x, a.accuracy->relative.y, a.accuracy->relative.z})
      violations_ += axis.violation_count.value_or(0);
    return found.is_on_device;
  }

  DrawResult run(DrawRunner& runner, const Draw& draw, std::optional<DrawMaps>& maps) {
    DrawnLayers layers;
    DrawResult result = runner.run(draw.setup(), {terrain_}, MetricsKind::verdict, layers);
    if (maps && !result.is_on_device) maps->add(layers, &*scene_.map_truth);
    return result;
  }

  void expect_same_maps() {
    EXPECT_TRUE(device_->take_from_device(kept_, *found_));
    kept_ = 0;
    EXPECT_EQ(found_->draws, expected_->draws);
    EXPECT_TRUE(std::ranges::equal(found_->invalid.values(), expected_->invalid.values()));
    for (std::size_t k = 0; k < kCountedFlags.size(); ++k)
      EXPECT_TRUE(std::ranges::equal(found_->failing[k].values(), expected_->failing[k].values()));
    EXPECT_TRUE(std::ranges::equal(found_->count.values(), expected_->count.values()));
    for (const auto& [a, b] :
         {std::pair{&expected_->e_z, &found_->e_z}, std::pair{&*expected_->e_map, &*found_->e_map}}) {
      EXPECT_TRUE(std::ranges::equal(b->count.values(), a->count.values()));
      EXPECT_TRUE(std::ranges::equal(b->sum.values(), a->sum.values()));
      EXPECT_TRUE(std::ranges::equal(b->squares.values(), a->squares.values()));
    }
  }

  static constexpr GridSpec kGrid{0.1, -60, -60, 121, 101};
  TriangulatedGrid terrain_ = rough_terrain();
  std::vector<double> ranges_;
  std::shared_ptr<DeviceUse> use_ = std::make_shared<DeviceUse>();
  DrawsScene scene_;
  std::unique_ptr<DrawRunner> cpu_, device_;
  std::optional<DrawMaps> expected_, found_;
  std::int64_t kept_ = 0, violations_ = 0;
};

TEST_F(DeviceJudging, RandomRules) {
  std::mt19937_64 random(11);
  const auto one_of = [&](const std::vector<double>& values) { return values[random() % values.size()]; };
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Draw draw{.seed = seed};
    draw.errors = {.range_sigma_m = one_of({0, 0.02, 0.1}),
                   .dropout_frac = one_of({0, 0.3, 0.95}),
                   .incidence_sigma_rad = seed > 15 ? one_of({0, 1e-4}) : 0};  // loads the beams again
    draw.method = seed % 3 == 0 ? Method::bilinear4 : Method::bilinear_nearest;
    draw.truth_at = seed % 2 == 0 ? TruthAt::bin_center : TruthAt::centroid;
    EvaluationLimits limits{.hole_size = 3};
    limits.relative_z_m = one_of({0, 0.03, 0.06, 0.1, 1});
    limits.relative_xy_m = one_of({0, 0.02, 0.04, 0.06, 1});
    limits.horizontal_m = one_of({0, 0.2, 0.3, 0.35, 0.4, 1});
    draw.evaluation = rule(limits, one_of({0.1, 0.5, 1.7, 1.7, 3, 14}));
    draw.evaluation.footprint_shape = random() % 2 == 0 ? FootprintShape::square : FootprintShape::disc;
    draw.evaluation.quantile = one_of({0, 0.5, 0.95, 0.95, 0.999, 1});
    EXPECT_TRUE(expect_same_metrics(draw)) << seed;
    if (seed % 12 == 0) expect_same_maps();
  }
  expect_same_maps();
  EXPECT_GT(violations_, 100000);
  EXPECT_EQ(use_->draws(), 30U);
}

TEST_F(DeviceJudging, NothingReturns) {
  EXPECT_TRUE(expect_same_metrics({.errors = {.dropout_frac = 1}}));
  expect_same_maps();
}

// Rounding of hypot() would decide.
TEST_F(DeviceJudging, AnErrorAtItsLimitIsForTheCpu) {
  Draw draw{.evaluation = rule({}, kGrid.resolution_m)};
  DrawGridder gridder({ranges_}, kGrid);
  const Simulation simulation(device_scan({}, 1), nullptr, &terrain_);
  const DrawnDem dem = drawn(gridder, simulation, draw.method, draw.truth_at, terrain_);
  const BinIndex bin{60, 60};
  ASSERT_GT(dem.count.at(bin), 0);
  const double error_m =
      std::hypot(dem.layers.truth->x.at(bin) - kGrid.x(60), dem.layers.truth->y.at(bin) - kGrid.y(60));
  draw.evaluation.limits.horizontal_m = error_m;
  EXPECT_FALSE(expect_same_metrics(draw));
  draw.evaluation.limits.horizontal_m = error_m * (1 + 1e-9);
  EXPECT_TRUE(expect_same_metrics(draw));
  expect_same_maps();
}

TEST_F(DeviceJudging, LargeErrorsAndFootprintsAreForTheCpu) {
  EXPECT_FALSE(expect_same_metrics({.evaluation = rule({}, 26)}));
  use_ = std::make_shared<DeviceUse>();
  start(false);
  EXPECT_FALSE(expect_same_metrics({.errors = {.range_bias_m = -70000}, .method = Method::mean}));
  EXPECT_EQ(use_->draws(), 1U);
}

TEST_F(DeviceJudging, WithoutMapsNothingStaysOnTheDevice) {
  start(false);
  EXPECT_FALSE(expect_same_metrics({}));
  EXPECT_EQ(use_->draws(), 1U);
}

// Draws on an OpenCL device against those of the CPU, to the last bit. The device is pocl's, the CPU, unless
// the machine has another one.
std::int64_t different(std::span<const double> a, std::span<const double> b) {
  std::int64_t count = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    count += std::bit_cast<std::uint64_t>(a[i]) == std::bit_cast<std::uint64_t>(b[i]) ? 0 : 1;
  return count;
}

class DeviceGridding : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
    trace(2);
  }

  void trace(int columns) {
    columns_ = columns;
    ranges_ = device_scan_ranges(columns);
  }

  [[nodiscard]] OpenClOptions options() const { return {.use = use_}; }

  /// Draws on both; fails unless the bytes of all layers are equal. Returns the returns in the bins.
  std::int64_t expect_same_bits(DrawGridder& device, const RangeErrorParameters& errors, Method method,
                                TruthAt truth_at, std::uint64_t seed, const GridSpec& grid) {
    DrawGridder cpu({ranges_}, grid);
    const Simulation simulation(device_scan(errors, seed, columns_), nullptr, &terrain_);
    const DrawnDem expected = drawn(cpu, simulation, method, truth_at, terrain_);
    const std::uint64_t before = use_->draws();
    const DrawnDem found = drawn(device, simulation, method, truth_at, terrain_);
    EXPECT_EQ(use_->draws(), before + 1);
    EXPECT_FALSE(use_->failure());
    EXPECT_EQ(different(found.layers.z_est.values(), expected.layers.z_est.values()), 0);
    EXPECT_EQ(different(found.layers.truth->x.values(), expected.layers.truth->x.values()), 0);
    EXPECT_EQ(different(found.layers.truth->y.values(), expected.layers.truth->y.values()), 0);
    EXPECT_EQ(different(found.layers.truth->z.values(), expected.layers.truth->z.values()), 0);
    std::int64_t wrong = 0, returns = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      wrong += found.count.values()[i] == expected.count.values()[i] ? 0 : 1;
      returns += expected.count.values()[i];
    }
    EXPECT_EQ(wrong, 0);
    return returns;
  }

  PlaneTerrain terrain_;
  GridSpec grid_{0.05, -140, -140, 281, 201};
  int columns_ = 2;
  std::vector<double> ranges_;
  std::shared_ptr<DeviceUse> use_ = std::make_shared<DeviceUse>();
};

const std::vector<RangeErrorParameters>& error_models() {
  static const std::vector<RangeErrorParameters> all = {
      {},
      {.range_bias_m = 0.25},
      {.range_sigma_m = 0.1, .range_bias_m = -0.01},
      {.range_sigma_m = 0.02, .dead_pixel_frac = 0.3, .dropout_frac = 0.2},
      {.range_sigma_m = 0.02, .range_sigma_per_m = 1e-3},
      {.range_sigma_m = 0.02, .range_sigma_per_m = 1e-3, .incidence_sigma_rad = 1e-3},
      {.range_sigma_m = 0.05,
       .dead_pixel_frac = 0.2,
       .dropout_frac = 0.1,
       .incidence_sigma_rad = 1e-3,
       .false_return_frac = 0.2,
       .false_min_m = 300,
       .false_max_m = 600}};
  return all;
}

TEST_F(DeviceGridding, EveryErrorAndMethod) {
  DrawGridder device({ranges_}, grid_, options());
  std::uint64_t seed = 10;
  for (const Method method : {Method::bilinear_nearest, Method::mean, Method::bilinear4})
    for (const RangeErrorParameters& errors : error_models()) {
      const TruthAt truth_at = ++seed % 2 == 0 ? TruthAt::bin_center : TruthAt::centroid;
      EXPECT_GT(expect_same_bits(device, errors, method, truth_at, seed, grid_), 5000);
    }
}

// Thousands of returns in a bin, and a grid beside the site's centre.
TEST_F(DeviceGridding, CoarseAndDistantBins) {
  for (const GridSpec& grid :
       {GridSpec{4, -2, -2, 5, 5}, GridSpec{20, 0, 0, 1, 1}, GridSpec{0.3, 3, -11, 7, 9}}) {
    DrawGridder device({ranges_}, grid, options());
    for (const Method method : {Method::bilinear_nearest, Method::bilinear4})
      EXPECT_GT(expect_same_bits(device, error_models().back(), method, TruthAt::bin_center, 3, grid), 100);
  }
}

// 2.4 million beams: three chunks, the last one shorter.
TEST_F(DeviceGridding, SeveralChunks) {
  trace(20);
  DrawGridder device({ranges_}, grid_, options());
  for (const Method method : {Method::bilinear_nearest, Method::bilinear4})
    EXPECT_GT(expect_same_bits(device, error_models().back(), method, TruthAt::bin_center, 3, grid_),
              1000000);
}

// The last bits of a normal deviate are lost in a range of 500 m, but not here.
TEST_F(DeviceGridding, EveryBitOfTheNoise) {
  const GridSpec grid{50, -200, -200, 401, 401};
  DrawGridder device({ranges_}, grid, options());
  for (std::uint64_t seed = 1; seed < 6; ++seed)
    EXPECT_GT(expect_same_bits(device, {.range_sigma_m = 1e6}, Method::mean, TruthAt::centroid, seed, grid),
              100000);
}

TEST_F(DeviceGridding, NothingReturns) {
  DrawGridder device({ranges_}, grid_, options());
  EXPECT_EQ(expect_same_bits(device, {.dropout_frac = 1}, Method::bilinear4, TruthAt::bin_center, 3, grid_),
            0);
  EXPECT_EQ(expect_same_bits(device, {.dead_pixel_frac = 1}, Method::mean, TruthAt::bin_center, 3, grid_), 0);
}

TEST_F(DeviceGridding, RefusesWhatADeviceCannotDo) {
  DrawGridder device({ranges_}, grid_, options());
  const Simulation simulation(device_scan({}, 1), nullptr, &terrain_);
  EXPECT_THAT(
      [&] { static_cast<void>(drawn(device, simulation, Method::median, TruthAt::bin_center, terrain_)); },
      testing::ThrowsMessage<UsageError>(HasSubstr("/regrid/method: a device bins by bilinear_nearest, "
                                                   "bilinear4 or mean; opencl-or-cpu uses the CPU")));
  ScanModel timed = device_scan({}, 1);
  timed.lidar.range_timer = RangeTimer({.timer_step_s = 1e-9}, 6, 1);
  EXPECT_THAT([&] { device.device()->check(Simulation(std::move(timed), nullptr, &terrain_), Method::mean); },
              testing::ThrowsMessage<UsageError>(HasSubstr("/scan/receiver: a device draws no jitter")));
}

TEST_F(DeviceGridding, FallsBackForADraw) {
  DrawGridder device({ranges_}, grid_, OpenClOptions{.on_failure = DeviceFailure::falls_back, .use = use_});
  const Simulation simulation(device_scan({}, 1), nullptr, &terrain_);
  const DrawnDem median = drawn(device, simulation, Method::median, TruthAt::bin_center, terrain_);
  EXPECT_GT(median.count.at({140, 100}), 0);
  EXPECT_EQ(use_->draws(), 0U);
  EXPECT_EQ(use_->failure(), "/regrid/method: a device bins by bilinear_nearest, bilinear4 or mean");
  static_cast<void>(drawn(device, simulation, Method::mean, TruthAt::bin_center, terrain_));
  EXPECT_EQ(use_->draws(), 1U);
}

}  // namespace
}  // namespace landfall
