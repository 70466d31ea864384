// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "chain/gridding/moment_accumulator.h"
#include "chain/gridding/weighted_mean_accumulator.h"
#include "constants.h"
#include "return_columns.h"

namespace landfall {
namespace {

MomentAccumulator moments_of(const GridSpec& spec, const std::vector<ReturnPoint>& points,
                             std::size_t batch = SIZE_MAX) {
  WeightedMeanAccumulator bins(spec);
  MomentAccumulator moments(spec);
  const ReturnColumns columns(points);
  for (std::size_t begin = 0; begin < points.size(); begin += std::min(batch, points.size())) {
    const GridPoints piece = columns.view().subset(begin, std::min(batch, points.size() - begin));
    bins.add(piece);
    moments.add(piece, bins);
  }
  return moments;
}

std::vector<ReturnPoint> random_points(std::size_t count) {
  std::mt19937_64 random(20261121);
  std::uniform_real_distribution<double> coordinate(-1.7, 1.7);
  std::vector<ReturnPoint> points(count);
  for (ReturnPoint& p : points)
    p = {.x_est = coordinate(random), .y_est = coordinate(random), .z_est = 1000 + coordinate(random)};
  return points;
}

// Bins of 1 m; bin (1, 0) has its centre in (0, -1) and its first return at z = 10.
TEST(MomentAccumulator, SumsByHand) {
  const MomentAccumulator moments =
      moments_of(GridSpec::centered(1, 1),
                 {{.x_est = 0.25, .y_est = -1.5, .z_est = 10}, {.x_est = -0.5, .y_est = -0.75, .z_est = 12}});
  const BinMoments& bin = moments.bins()[moments.spec().index({0, 1})];
  const double w1 = 0.75 * 0.5;
  const double w2 = 0.5 * 0.75;
  EXPECT_FLOAT_EQ(bin.w_w, static_cast<float>(w1 * w1 + w2 * w2));
  EXPECT_FLOAT_EQ(bin.w_dx_dx, static_cast<float>(w1 * 0.0625 + w2 * 0.25));
  EXPECT_FLOAT_EQ(bin.w_dx_dy, static_cast<float>(w1 * 0.25 * -0.5 + w2 * -0.5 * 0.25));
  EXPECT_FLOAT_EQ(bin.w_dy_dy, static_cast<float>(w1 * 0.25 + w2 * 0.0625));
  EXPECT_FLOAT_EQ(bin.w_dx_dz, static_cast<float>(w2 * -0.5 * 2));
  EXPECT_FLOAT_EQ(bin.w_dy_dz, static_cast<float>(w2 * 0.25 * 2));
  EXPECT_EQ(moments.bins()[0].w_w, 0);
}

TEST(MomentAccumulator, PointsOutsideAreLeftOut) {
  const MomentAccumulator moments = moments_of(GridSpec::centered(1, 1), {{.x_est = 5}, {.y_est = -1.51}});
  for (const BinMoments& bin : moments.bins()) EXPECT_EQ(bin.w_w, 0);
}

TEST(MomentAccumulator, SameBytesForAnyThreadsAndBatches) {
  const GridSpec spec = GridSpec::centered(1.6, 0.05);
  const std::vector<ReturnPoint> points = random_points(30000);
  const MomentAccumulator expected = moments_of(spec, points);
  for (const std::size_t threads : {1U, 2U, 7U})
    for (const std::size_t batch : {std::size_t{1000}, std::size_t{7777}}) {
      const ThreadLimit limit(threads);
      const MomentAccumulator actual = moments_of(spec, points, batch);
      EXPECT_EQ(0, std::memcmp(actual.bins().data(), expected.bins().data(), expected.bins().size_bytes()));
    }
}

// 3000 returns in a bin, against sums in double: single precision holds to about n 6e-8.
TEST(MomentAccumulator, SinglePrecisionIsEnough) {
  const GridSpec spec = GridSpec::centered(1, 1);
  const std::vector<ReturnPoint> points = random_points(27000);
  const MomentAccumulator moments = moments_of(spec, points);
  double w_w = 0;
  double w_dx_dx = 0;
  for (const ReturnPoint& p : points) {
    if (std::abs(p.x_est) >= 0.5 || std::abs(p.y_est) >= 0.5) continue;
    const double w = (1 - std::abs(p.x_est)) * (1 - std::abs(p.y_est));
    w_w += w * w;
    w_dx_dx += w * p.x_est * p.x_est;
  }
  const BinMoments& bin = moments.bins()[spec.index({1, 1})];
  EXPECT_NEAR(bin.w_w / w_w, 1, 2e-5);
  EXPECT_NEAR(bin.w_dx_dx / w_dx_dx, 1, 2e-5);
}

// 5 x 5 bins of 0.5 m, centres -1 .. 1 m.
GridSpec five_by_five() { return GridSpec::centered(1, 0.5); }

const BinSums& at(const WeightedMeanAccumulator& bins, BinIndex bin) {
  return bins.bins()[bins.spec().index(bin)];
}

double weight_of(double x_m, double y_m) {
  const WeightedMeanAccumulator bins = accumulated(five_by_five(), {{.x_est = x_m, .y_est = y_m}});
  double sum = 0;
  for (const BinSums& bin : bins.bins()) sum += bin.weight;
  return sum;
}

// Eq. 9.
TEST(WeightedMeanAccumulator, WeightsByHand) {
  EXPECT_EQ(weight_of(0.5, -0.5), 1);             // on a centre
  EXPECT_EQ(weight_of(0.625, -0.5), 0.75);        // p = 1/4
  EXPECT_EQ(weight_of(0.625, -0.4375), 0.65625);  // p = 1/4, q = 1/8
  EXPECT_EQ(weight_of(0.375, -0.5625), 0.65625);  // the same on the other sides
  EXPECT_EQ(weight_of(0.25, 0.25), 0.25);         // a corner of the bin: the least weight
  EXPECT_EQ(weight_of(-0.75, 0), 0.5);            // the middle of an edge
}

TEST(WeightedMeanAccumulator, BinsAtNegativeCoordinatesAndOnEdges) {
  const WeightedMeanAccumulator bins =
      accumulated(five_by_five(), {{.x_est = -0.3, .y_est = -0.9},      // bin (-0.5, -1)
                                   {.x_est = -0.2, .y_est = 0.2},       // bin (0, 0)
                                   {.x_est = -0.25, .y_est = 0.25},     // edge: greater bin
                                   {.x_est = -0.75, .y_est = -0.75}});  // the opposite corner
  EXPECT_EQ(at(bins, {0, 1}).count, 1);
  EXPECT_EQ(at(bins, {2, 2}).count, 1);
  EXPECT_EQ(at(bins, {3, 2}).count, 1);
  EXPECT_EQ(at(bins, {1, 1}).count, 1);
  EXPECT_EQ(bins.inside_count(), 4);
}

TEST(WeightedMeanAccumulator, CountsWhatLiesOutside) {
  const WeightedMeanAccumulator bins =
      accumulated(five_by_five(), {{.x_est = -1.25},  // border: the first bin's edge
                                   {.x_est = 1.25},   // belongs to the bin beyond
                                   {.y_est = -1.2501},
                                   {.y_est = 1e300},
                                   {.x_est = 1.2499, .y_est = 1.2499}});
  EXPECT_EQ(bins.inside_count(), 2);
  EXPECT_EQ(bins.outside_count(), 3);
  EXPECT_EQ(at(bins, {2, 0}).count, 1);
  EXPECT_EQ(at(bins, {4, 4}).count, 1);
}

// Eq. 8, numerator and denominator.
TEST(WeightedMeanAccumulator, SumsByHand) {
  // Weights 1 and 0.75 in the bin at (0.5, 0).
  const WeightedMeanAccumulator bins = accumulated(
      five_by_five(), {{.x_est = 0.5, .z_est = 3, .x_true = 0.25, .y_true = 1, .z_true = 9, .t = 8},
                       {.x_est = 0.625, .z_est = 7, .x_true = 0.5, .y_true = -1, .z_true = 9, .t = 4}});
  const BinSums& bin = at(bins, {2, 3});
  EXPECT_EQ(bin.count, 2);
  EXPECT_EQ(bin.weight, 1.75);
  EXPECT_EQ(bin.z_first, 3);
  EXPECT_EQ(bin.w_dz, 3);
  EXPECT_EQ(bin.w_dz_dz, 12);
  EXPECT_EQ(bin.w_x_true, 0.625);
  EXPECT_EQ(bin.w_y_true, 0.25);
  EXPECT_EQ(bin.w_x_est, 0.96875);
  EXPECT_EQ(bin.w_y_est, 0);
  EXPECT_EQ(bin.w_t, 11);
}

TEST(WeightedMeanAccumulator, NothingAddedIsEmpty) {
  WeightedMeanAccumulator bins(five_by_five());
  bins.add({});
  EXPECT_EQ(bins.inside_count(), 0);
  EXPECT_EQ(at(bins, {2, 2}).count, 0);
  EXPECT_EQ(at(bins, {2, 2}).weight, 0);
}

TEST(WeightedMeanAccumulator, RefusesAnImpossibleGrid) {
  EXPECT_THROW(WeightedMeanAccumulator(GridSpec{0, 0, 0, 5, 5}), UsageError);
  EXPECT_THROW(WeightedMeanAccumulator(GridSpec{kNan, 0, 0, 5, 5}), UsageError);
  EXPECT_THROW(WeightedMeanAccumulator(GridSpec{kInfinity, 0, 0, 5, 5}), UsageError);
  EXPECT_THROW(WeightedMeanAccumulator(GridSpec{1, 0, 0, 0, 5}), UsageError);
  EXPECT_THROW(WeightedMeanAccumulator(GridSpec{1, 0, 0, 5, -1}), UsageError);
  EXPECT_THROW(WeightedMeanAccumulator(GridSpec{1, 0, 0, 5, 0}), UsageError);
  EXPECT_NO_THROW(WeightedMeanAccumulator(GridSpec{1, 0, 0, 1, 1}));
}

TEST(WeightedMeanAccumulator, OnePassIsAllOfTheProgress) {
  WeightedMeanAccumulator bins(five_by_five());
  EXPECT_EQ(bins.progress(0.25), 0.25);
  EXPECT_FALSE(bins.end_pass());
}

}  // namespace
}  // namespace landfall
