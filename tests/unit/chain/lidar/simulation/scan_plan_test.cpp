// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "analytic_engines.h"
#include "base/core/parallel.h"
#include "bins.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/simulation/incidence.h"
#include "chain/lidar/simulation/pulse_batch.h"
#include "chain/lidar/simulation/scan_pipeline.h"
#include "chain/lidar/simulation/scan_plan.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "constants.h"

namespace landfall {
namespace {

using enum PointStatus;
using testing::ElementsAre;

/// z = slope_x x on 3 x 3 nodes.
TriangulatedGrid plane(double slope_x) {
  return TriangulatedGrid(grid_of(GridSpec::centered(1, 1), [&](double x, double) { return slope_x * x; }));
}

/// A beam in the x-z plane, `off_nadir_rad` from straight down towards +x.
Direction<DemFrame> beam(double off_nadir_rad) {
  return {{std::sin(off_nadir_rad), 0, -std::cos(off_nadir_rad)}};
}

// A plane that rises to +x by `tilt` meets a beam leaning to +x by `lean` at tilt - lean from its normal.
TEST(Incidence, IsTiltMinusLean) {
  for (const double tilt : {-0.5, 0.0, 0.3})
    for (const double lean : {-0.2, 0.0, 1e-9, 0.4}) {
      const double measured =
          tan_incidence(plane(std::tan(tilt)), {{0.2, 0.1, std::tan(tilt) * 0.2}}, beam(lean));
      EXPECT_NEAR(measured, std::tan(std::abs(tilt - lean)), 1e-15) << tilt << ' ' << lean;
    }
}

TEST(Incidence, EndsAt89Degrees) {
  EXPECT_NEAR(tan_incidence(plane(0), {{0, 0, 0}}, beam(kPi / 2)), std::tan(89 * kPi / 180), 1e-9);
  EXPECT_NEAR(tan_incidence(plane(0), {{0, 0, 0}}, beam(89.7 * kPi / 180)), std::tan(89 * kPi / 180), 1e-9);
  EXPECT_NEAR(tan_incidence(plane(0), {{0, 0, 0}}, beam(88 * kPi / 180)), std::tan(88 * kPi / 180), 1e-12);
}

TEST(Incidence, HolesHaveNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(tan_incidence(plane(nan), {{0, 0, 0}}, beam(0.3)), 0);
  EXPECT_TRUE(std::isnan(tan_incidence(plane(0), {{nan, nan, nan}}, beam(0))));
}

// Three pulses of two pixels; the rows are numbered in every column.
PulseBatch numbered(std::initializer_list<PointStatus> status) {
  PulseBatch batch;
  batch.resize(3, 2);
  for_each_column(kPointColumns, [&](const auto& column) {
    auto& rows = batch.points.*column.rows;
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<std::decay_t<decltype(rows[0])>>(i);
  });
  batch.points.status = status;
  batch.pulses.point_count = {2, 2, 2};
  return batch;
}

TEST(PulseBatch, ResizesTheColumnsOfTheScan) {
  PulseBatch batch;
  for (const OptionalColumns& optional :
       {OptionalColumns{}, OptionalColumns{.intensity = true}, OptionalColumns{true, true, true}}) {
    batch.resize(4, 3, PointContent::all, optional);
    for_each_column(kPointColumns, [&](const auto& column) {
      EXPECT_EQ((batch.points.*column.rows).size(), optional.has(column.group) ? 12U : 0U) << column.name;
    });
  }
  for_each_column(kPulseColumns, [&](const auto& column) {
    EXPECT_EQ((batch.pulses.*column.rows).size(), 4U) << column.name;
  });
}

TEST(PulseBatch, CanHoldOnlyThePlaces) {
  PulseBatch batch;
  batch.resize(4, 3, PointContent::places, OptionalColumns{true, true, true});
  std::vector<std::string> filled;
  for_each_column(kPointColumns, [&](const auto& column) {
    if (!(batch.points.*column.rows).empty()) filled.emplace_back(column.name);
  });
  EXPECT_THAT(filled, ElementsAre("x_est", "y_est", "z_est", "x_true", "y_true", "z_true", "status"));
  EXPECT_TRUE(batch.points.holds_truth());
}

TEST(PulseBatch, CanLeaveOutTheTruth) {
  PulseBatch batch;
  batch.resize(4, 3);
  batch.resize(4, 3, PointContent::estimate);
  EXPECT_FALSE(batch.points.holds_truth());
  std::vector<std::string> filled;
  for_each_column(kPointColumns, [&](const auto& column) {
    const auto& rows = batch.points.*column.rows;
    if (rows.empty()) return;
    EXPECT_EQ(rows.size(), 12U) << column.name;
    filled.emplace_back(column.name);
  });
  EXPECT_THAT(filled, ElementsAre("x_est", "y_est", "z_est", "range_measured", "status"));
  batch.points.status.assign(12, miss);
  batch.points.status[5] = returned;
  batch.points.x_est[5] = 7;
  batch.pulses.point_count.assign(4, 3);
  batch.keep_returns();
  EXPECT_THAT(batch.points.x_est, ElementsAre(7));
  EXPECT_TRUE(batch.points.x_true.empty());
  EXPECT_THAT(batch.pulses.point_count, ElementsAre(0, 1, 0, 0));
}

TEST(PulseBatch, CountsEachStatus) {
  const PulseBatch batch = numbered({returned, miss, returned, dead, false_return, blanked});
  EXPECT_THAT(batch.status_counts(), ElementsAre(2, 1, 0, 1, 1, 0, 1, 0));
}

TEST(PulseBatch, KeepsReturnsInOrder) {
  PulseBatch batch = numbered({miss, returned, dropout, dead, false_return, returned});
  batch.keep_returns();
  EXPECT_THAT(batch.points.x_est, ElementsAre(1, 4, 5));
  EXPECT_THAT(batch.points.range_measured, ElementsAre(1, 4, 5));
  EXPECT_THAT(batch.points.pixel, ElementsAre(1, 4, 5));
  EXPECT_THAT(batch.points.status, ElementsAre(returned, false_return, returned));
  EXPECT_THAT(batch.pulses.point_count, ElementsAre(1, 0, 2));
  EXPECT_EQ(batch.pulses.t.size(), 3U);
}

TEST(PulseBatch, KeepingReturnsTwiceIsKeepingThemOnce) {
  PulseBatch batch = numbered({returned, returned, blanked, lost_in_optics, miss, returned});
  batch.keep_returns();
  const PointColumns once = batch.points;
  batch.keep_returns();
  EXPECT_EQ(batch.points, once);
  EXPECT_THAT(batch.pulses.point_count, ElementsAre(2, 0, 1));
}

/// 100 pulses of one pixel.
ScanModel small_scan() {
  return ScanModel{.lidar = {.detector = perspective_detector({.rows = 1, .columns = 1}),
                             .scanner = std::make_unique<Flash>(),
                             .range_errors = RangeErrors({}, 1)},
                   .trajectory = std::make_unique<ConstantVelocity>(ConstantVelocityParameters{}),
                   .pulse_rate_hz = 100,
                   .scan_time_s = 1};
}

class ScanPipeline : public testing::Test {
 protected:
  const PlaneEngine engine_;
  const Simulation simulation_{small_scan(), &engine_};
  const ThreadLimit threads_{2};
};

TEST_F(ScanPipeline, GivesBatchesAndTheirWorkInOrder) {
  std::vector<std::int64_t> taken;
  std::vector<std::int64_t> finished;
  double progress = 0;
  run_scan(
      simulation_, {},
      [&](PulseBatch& batch) {
        const std::int64_t first = batch.points.pulse.front();
        taken.insert(taken.end(), batch.points.pulse.begin(), batch.points.pulse.end());
        return SinkWork{{}, [&finished, first] { finished.push_back(first); }};
      },
      7, [&](double fraction) { progress = fraction; });
  ASSERT_EQ(taken.size(), 100U);
  for (std::size_t i = 0; i < taken.size(); ++i) EXPECT_EQ(taken[i], static_cast<std::int64_t>(i));
  ASSERT_EQ(finished.size(), 15U);
  for (std::size_t i = 0; i < finished.size(); ++i) EXPECT_EQ(finished[i], static_cast<std::int64_t>(7 * i));
  EXPECT_EQ(progress, 1);
}

TEST_F(ScanPipeline, APlanHasEveryPulse) {
  const ScanPlan plan = plan_scan(simulation_, Grid<std::int8_t>(GridSpec::centered(1, 1), 1), 7);
  EXPECT_EQ(plan.return_count(), 100);
  EXPECT_EQ(plan.pulses(), (PulseBudget{.in_region = 100}));
  EXPECT_EQ(plan.frames().at({1, 1}), 100);
}

// The first batch fails when later ones wait for it before the last stage, where oneTBB itself destroys
// nothing.
TEST_F(ScanPipeline, KeepsNothingOfARunThatFails) {
  const auto held = std::make_shared<int>();
  std::atomic<bool> others_wait = false;
  const auto sink = [&](PulseBatch& batch) {
    const std::int64_t number = batch.points.pulse.front();
    const auto work = [held, number, &others_wait] {
      if (number == 3) others_wait = true;
      const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
      while (number == 0 && !others_wait && std::chrono::steady_clock::now() < end) std::this_thread::yield();
      if (number == 0) throw std::runtime_error("the disk is full");
    };
    return SinkWork{work, {}};
  };
  EXPECT_THROW(run_scan(simulation_, {}, sink, 1), std::runtime_error);
  EXPECT_EQ(held.use_count(), 1);
}

TEST_F(ScanPipeline, ThrowsWhatTheSourceThrows) {
  Replay replay;
  replay.ranges = [](PulseSpan pulses) -> RecordedRanges {
    if (pulses.first >= 20) throw std::runtime_error("no more");
    return RecordedRanges{std::vector<double>(static_cast<std::size_t>(pulses.count), 500.0)};
  };
  std::int64_t taken = 0;
  const auto sink = [&](PulseBatch& batch) {
    taken += static_cast<std::int64_t>(batch.points.pulse.size());
    return SinkWork{};
  };
  EXPECT_THROW(run_scan(simulation_, replay, sink, 10), std::runtime_error);
  EXPECT_LE(taken, 20);
}

struct Place {
  double x, y;
  PointStatus status = returned;
};

/// Pulses k = first .. at t = k / 10 s, each with its pixels' places.
PulseBatch batch_of(std::int32_t first, const std::vector<std::vector<Place>>& pulses) {
  PulseBatch batch;
  for (std::size_t k = 0; k < pulses.size(); ++k) {
    const std::int32_t pulse = first + static_cast<std::int32_t>(k);
    batch.pulses.t.push_back(pulse / 10.0);
    batch.pulses.point_count.push_back(static_cast<std::int32_t>(pulses[k].size()));
    for (const Place& place : pulses[k]) {
      batch.points.x_true.push_back(place.x);
      batch.points.y_true.push_back(place.y);
      batch.points.pulse.push_back(pulse);
      batch.points.status.push_back(place.status);
    }
  }
  return batch;
}

/// 3 x 3 bins of 1 m, of which the middle row is the region.
ScanPlan middle_row() {
  Grid<std::int8_t> region(GridSpec::centered(1, 1));
  for (std::int64_t col = 0; col < 3; ++col) region.at({1, col}) = 1;
  return ScanPlan(std::move(region));
}

TEST(ScanPlan, CountsReturnsImagesAndFirstSights) {
  ScanPlan plan = middle_row();
  plan.add(batch_of(0, {{{0, 0}, {0.4, -0.4}, {1, 0}}, {{0, 0}, {0, 1}}}));
  plan.add(batch_of(2, {{{0, 0}, {0, 0, miss}, {9, 9}}}));
  EXPECT_THAT(plan.count().values(), ElementsAre(0, 0, 0, 0, 4, 1, 0, 1, 0));
  EXPECT_THAT(plan.frames().values(), ElementsAre(0, 0, 0, 0, 3, 1, 0, 1, 0));
  EXPECT_EQ(plan.first_seen_s().at({1, 1}), 0);
  EXPECT_EQ(plan.first_seen_s().at({2, 1}), 0.1F);
  EXPECT_TRUE(std::isnan(plan.first_seen_s().at({0, 0})));
  EXPECT_EQ(plan.return_count(), 7);
  EXPECT_EQ(plan.region_return_count(), 5);
}

TEST(ScanPlan, EveryPulseIsOfOneKind) {
  ScanPlan plan = middle_row();
  plan.add(batch_of(0, {{{0, 0}, {1, 0}},                              // in
                        {{0, 0}, {0, 1}},                              // partly
                        {{0, 1}, {7, 7}},                              // off
                        {{0, 0, miss}, {0, 0, dropout}},               // off: fired, and nothing came back
                        {{0, 0, blanked}, {0, 0, dead}},               // blanked
                        {{0, 0, dead}, {0, 0}},                        // in
                        {{0, 0, lost_in_optics}, {0, 0, blanked}}}));  // off: it was fired
  EXPECT_EQ(plan.pulses(), (PulseBudget{2, 1, 3, 1}));
}

TEST(ScanPlan, BatchesMayBeCutAnywhere) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2, 2);
  std::vector<std::vector<Place>> pulses(60, std::vector<Place>(5));
  for (auto& pulse : pulses)
    for (Place& p : pulse) p = {place(random), place(random), random() % 4 == 0 ? miss : returned};
  ScanPlan whole = middle_row();
  whole.add(batch_of(0, pulses));
  ScanPlan pieces = middle_row();
  for (std::int32_t k = 0; k < 60; k += 20)
    pieces.add(batch_of(k, {pulses.begin() + k, pulses.begin() + k + 20}));
  EXPECT_EQ(std::vector(whole.count().values().begin(), whole.count().values().end()),
            std::vector(pieces.count().values().begin(), pieces.count().values().end()));
  EXPECT_EQ(whole.pulses(), pieces.pulses());
  EXPECT_GT(whole.pulses().partly_in_region, 0);
}

TEST(BinSpread, ByHand) {
  const GridSpec spec{1, 0, 0, 1, 21};
  Grid<std::int32_t> values(spec);
  Grid<std::int8_t> region(spec, 1);
  for (std::int64_t i = 0; i < 20; ++i) values.at({0, i}) = static_cast<std::int32_t>(i);
  values.at({0, 20}) = 1000;
  region.at({0, 20}) = 0;
  const BinSpread spread = spread_over_region(values, region);  // 0 .. 19
  EXPECT_DOUBLE_EQ(spread.mean, 9.5);
  EXPECT_EQ(spread.min, 0);
  EXPECT_EQ(spread.p05, 0);
  EXPECT_EQ(spread.median, 9);
  EXPECT_EQ(spread.p95, 18);
  EXPECT_EQ(spread.max, 19);
  EXPECT_DOUBLE_EQ(spread.above_one_frac, 0.9);
}

TEST(BinSpread, AllEqual) {
  const GridSpec spec{1, 0, 0, 2, 2};
  const BinSpread spread = spread_over_region(Grid<std::int32_t>(spec, 3), Grid<std::int8_t>(spec, 1));
  EXPECT_EQ(spread.min, 3);
  EXPECT_EQ(spread.p95, 3);
  EXPECT_EQ(spread.above_one_frac, 1);
  EXPECT_EQ(spread_over_region(Grid<std::int32_t>(spec), Grid<std::int8_t>(spec, 1)).above_one_frac, 0);
}

}  // namespace
}  // namespace landfall
