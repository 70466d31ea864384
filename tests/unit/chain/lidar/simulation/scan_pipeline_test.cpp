// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/scan_pipeline.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "analytic_engines.h"
#include "base/core/parallel.h"
#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/simulation/scan_plan.h"
#include "chain/lidar/trajectory/trajectories.h"

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
