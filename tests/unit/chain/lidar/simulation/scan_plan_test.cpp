// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/scan_plan.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace landfall {
namespace {

using enum PointStatus;
using testing::ElementsAre;

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
