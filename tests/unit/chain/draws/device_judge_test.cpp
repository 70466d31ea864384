// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts and maps of an OpenCL device against those of the CPU, to the last bit. The device is pocl's, the
// CPU, unless the machine has another one.
#include "chain/draws/device_judge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "chain/draws/draw_runner.h"
#include "device_scan.h"
#include "no_opencl.h"

namespace landfall {
namespace {

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
  for (std::int64_t row = 0; row < nodes.spec().rows; ++row)
    for (std::int64_t col = 0; col < nodes.spec().cols; ++col)
      nodes.at({row, col}) = random() % 200 == 0 ? std::nan("")
                                                 : kPlane.z0_m + kPlane.slope_x * nodes.spec().x(col) +
                                                       kPlane.slope_y * nodes.spec().y(row) + normal(random);
  return TriangulatedGrid(std::move(nodes));
}

/// A campaign with and without a device.
class DeviceJudging : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!no_opencl().empty()) GTEST_SKIP() << no_opencl();
    ranges_ = device_scan_ranges();
    start(true);
  }

  void start(bool with_maps) {
    const BinMask region = circular_region(kGrid, 4);
    cpu_ = std::make_unique<DrawRunner>(DrawsScene{{ranges_}, &terrain_, kGrid, region}, with_maps);
    device_ = std::make_unique<DrawRunner>(DrawsScene{{ranges_}, &terrain_, kGrid, region}, with_maps,
                                           OpenClOptions{.use = use_});
    expected_ = with_maps ? std::optional(DrawMaps(kGrid)) : std::nullopt;
    found_ = expected_;
  }

  /// Runs a draw on both. Returns whether the device judged it, and keeps it for the maps.
  bool expect_same_metrics(const Draw& draw) {
    const DrawResult expected =
        cpu_->run(draw.setup(), {terrain_}, MetricsKind::verdict, expected_ ? &*expected_ : nullptr);
    const DrawResult found =
        device_->run(draw.setup(), {terrain_}, MetricsKind::verdict, found_ ? &*found_ : nullptr);
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

  void expect_same_maps() {
    EXPECT_TRUE(device_->take_from_device(kept_, *found_));
    kept_ = 0;
    EXPECT_EQ(found_->draws, expected_->draws);
    for (const auto layer : {&DrawMaps::invalid, &DrawMaps::fail_rel_x, &DrawMaps::fail_rel_y,
                             &DrawMaps::fail_rel_z, &DrawMaps::fail_absolute})
      EXPECT_TRUE(std::ranges::equal(((*found_).*layer).values(), ((*expected_).*layer).values()));
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
  const DrawnDem& dem = gridder.draw(simulation, draw.method, draw.truth_at, terrain_);
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

}  // namespace
}  // namespace landfall
