// SPDX-License-Identifier: GPL-3.0-or-later
// The draws against simulation and gridding in one batch.
#include "chain/draws/draw_gridder.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "bins.h"
#include "chain/draws/predicted_sigma.h"
#include "chain/gridding/moment_accumulator.h"
#include "chain/gridding/pose_track.h"
#include "chain/gridding/slope.h"
#include "chain/gridding/uncertainty.h"
#include "chain/gridding/weighted_mean_accumulator.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "plane_terrain.h"

namespace landfall {
namespace {

/// 40,000 pulses, by default of 4 pixels: more than one pass of the gridder. Returns beyond the map, but not
/// the first.
ScanModel scan(std::uint64_t seed, int columns = 2, double dropout_frac = 0.05) {
  ScanModel model{
      .lidar = {.detector = perspective_detector({.rows = 2, .columns = columns}),
                .scanner = std::make_unique<Fsm>(FsmParameters{}),
                .pattern = std::make_unique<LineSearch>(LineSearchParameters{.half_width_m = 6}),
                .range_errors = RangeErrors({.range_sigma_m = 0.1, .dropout_frac = dropout_frac}, seed)},
      .trajectory = std::make_unique<ConstantVelocity>(ConstantVelocityParameters{})};
  model.navigation_error = std::make_unique<LinearNavigationError>(
      NavigationErrorParameters{.position_m = {{0.3, 0, 0}}, .velocity_mps = {{0.1, 0, 0}}});
  return model;
}

class DrawGridding : public ::testing::Test {
 protected:
  explicit DrawGridding(int columns = 2) {
    const PlaneEngine engine(kPlane);
    const Simulation traced(scan(1, columns, 0), &engine);
    ranges_ = traced.simulate({0, traced.pulse_count()}).points.range_true;
  }

  [[nodiscard]] PulseBatch returns_of(const Simulation& simulation) const {
    PulseBatch batch;
    simulation.replay({0, simulation.pulse_count()}, {ranges_}, batch);
    batch.keep_returns();
    return batch;
  }

  void expect_equal(const DrawnDem& dem, const Simulation& simulation, Method method,
                    TruthAt truth_at) const {
    const PulseBatch batch = returns_of(simulation);
    const std::vector<double> no_times(batch.points.size());
    const auto bins = make_accumulator(method, grid_);
    do bins->add(GridPoints::of(batch.points, no_times));
    while (bins->end_pass());
    const auto elevation = [this](double x_m, double y_m) { return terrain_.elevation(x_m, y_m); };
    const auto same = [](double a, double b) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    };
    std::int64_t wrong = 0, empty = 0, off = 0;
    std::vector<BinValues> values(1);
    for (const BinIndex bin : bins_of(grid_)) {
      bins->values(bin, values);
      const BinValues& v = values.front();
      const double z_true = true_elevation(v, grid_, bin, elevation, truth_at);
      wrong += same(dem.layers.z_est.at(bin), v.z_est) && same(dem.layers.truth->x.at(bin), v.x_true) &&
                       same(dem.layers.truth->y.at(bin), v.y_true) &&
                       same(dem.layers.truth->z.at(bin), z_true) && dem.count.at(bin) == v.count
                   ? 0
                   : 1;
      empty += v.count == 0 ? 1 : 0;
      off += v.count > 0 && std::isnan(z_true) ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(empty, 0);
    EXPECT_GT(off, 0);
    EXPECT_LT(empty, 0.9 * static_cast<double>(grid_.size()));
  }

  PlaneTerrain terrain_;
  GridSpec grid_{0.05, -140, -140, 281, 201};
  std::vector<double> ranges_;
};

TEST_F(DrawGridding, EachDrawIsSimulationAndGridding) {
  DrawGridder gridder({ranges_}, grid_);
  using enum Method;
  DrawnDem dem;
  std::uint64_t seed = 5;
  for (const auto& [method, truth_at] :
       {std::pair{bilinear_nearest, TruthAt::bin_center}, std::pair{bilinear_nearest, TruthAt::centroid},
        std::pair{mean, TruthAt::bin_center}, std::pair{bilinear_nearest, TruthAt::bin_center},
        std::pair{median, TruthAt::centroid}, std::pair{median, TruthAt::bin_center},
        std::pair{bilinear_nearest, TruthAt::bin_center}}) {
    const Simulation simulation(scan(++seed), nullptr, &terrain_);
    gridder.draw(simulation, method, truth_at, terrain_, dem);
    expect_equal(dem, simulation, method, truth_at);
    if (method == median) dem.layers = {};  // as a caller that takes them
  }
}

/// 1.12 million points: more than one batch.
class SigmaPrediction : public DrawGridding {
 protected:
  static constexpr int kColumns = 14;
  SigmaPrediction() : DrawGridding(kColumns) {}
};

TEST_F(SigmaPrediction, IsTheUncertaintyOfTheReturns) {
  const UncertaintyParameters parameters{.range_sigma_m = 0.1};
  const DrawsScene scene{{ranges_}, &terrain_, grid_, BinMask(grid_, 1)};
  const Grid<float> predicted =
      predicted_sigma(scene, Simulation(scan(3, kColumns), nullptr, &terrain_), parameters).z_abs;
  const Simulation simulation(scan(3, kColumns), nullptr, &terrain_);
  const PulseBatch batch = returns_of(simulation);
  std::vector<double> times;
  for (const std::int32_t pulse : batch.points.pulse)
    times.push_back(batch.pulses.t[static_cast<std::size_t>(pulse)]);
  WeightedMeanAccumulator bins(grid_);
  MomentAccumulator moments(grid_);
  const GridPoints points = GridPoints::of(batch.points, times);
  bins.add(points);
  moments.add(points, bins);
  const Grid<landfall::Slope> slopes = slope_layer(bins);
  const PoseTrack poses({estimated_poses("the scan", batch.pulses)});
  const UncertaintyMap map(bins, moments, slopes, poses, parameters);
  std::vector<BinValues> values(1);
  std::int64_t wrong = 0, known = 0;
  for (const auto [row, col] : bins_of(grid_)) {
    bins.values({row, col}, values);
    const auto expected =
        static_cast<float>(values.front().count > 0 ? map.sigmas({row, col}).z_abs : BinSigmas::kUnknown);
    const float got = predicted.at({row, col});
    wrong += got == expected || (std::isnan(got) && std::isnan(expected)) ? 0 : 1;
    known += got > 0 ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(known, 1000);
}

}  // namespace
}  // namespace landfall
