// SPDX-License-Identifier: GPL-3.0-or-later
// Draws on an OpenCL device against those of the CPU, to the last bit. The device is pocl's, the CPU, unless
// the machine has another one.
#include "chain/draws/device_gridder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "chain/draws/draw_gridder.h"
#include "device_scan.h"
#include "no_opencl.h"

namespace landfall {
namespace {

using testing::HasSubstr;

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
    const DrawnDem& expected = cpu.draw(simulation, method, truth_at, terrain_);
    const std::uint64_t before = use_->draws();
    const DrawnDem& found = device.draw(simulation, method, truth_at, terrain_);
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
      [&] { static_cast<void>(device.draw(simulation, Method::median, TruthAt::bin_center, terrain_)); },
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
  const DrawnDem& median = device.draw(simulation, Method::median, TruthAt::bin_center, terrain_);
  EXPECT_GT(median.count.at({140, 100}), 0);
  EXPECT_EQ(use_->draws(), 0U);
  EXPECT_EQ(use_->failure(), "/regrid/method: a device bins by bilinear_nearest, bilinear4 or mean");
  static_cast<void>(device.draw(simulation, Method::mean, TruthAt::bin_center, terrain_));
  EXPECT_EQ(use_->draws(), 1U);
}

}  // namespace
}  // namespace landfall
