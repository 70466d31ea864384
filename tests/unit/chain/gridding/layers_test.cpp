// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bins.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "map_layers.h"
#include "return_columns.h"

namespace landfall {
namespace {

// 3 x 3 bins of 1 m.
GridSpec three_by_three() { return GridSpec::centered(1, 1); }

TEST(Layers, MeansByHand) {
  // Bin (0, 0): weights 1 and 0.5.
  const WeightedMeanAccumulator bins = accumulated(
      three_by_three(), {{.z_est = 10, .x_true = 0.5, .y_true = 0.25, .t = 2},
                         {.x_est = 0.5 - 0x1p-20, .z_est = 13, .x_true = 2, .y_true = -2, .t = 5}});
  const double w = 0.5 + 0x1p-20;
  EXPECT_NEAR(z_est_layer(bins).at({1, 1}), (10 + w * 13) / (1 + w), 1e-14);
  EXPECT_NEAR(x_true_layer(bins).at({1, 1}), (0.5 + w * 2) / (1 + w), 1e-15);
  EXPECT_NEAR(y_true_layer(bins).at({1, 1}), (0.25 - w * 2) / (1 + w), 1e-15);
  EXPECT_EQ(weight_sum_layer(bins).at({1, 1}), 1 + w);
  EXPECT_EQ(count_layer(bins).at({1, 1}), 2);
  EXPECT_FLOAT_EQ(x_est_mean_layer(bins).at({1, 1}), static_cast<float>(w * (0.5 - 0x1p-20) / (1 + w)));
  EXPECT_EQ(y_est_mean_layer(bins).at({1, 1}), 0);
  EXPECT_FLOAT_EQ(t_mean_layer(bins).at({1, 1}), static_cast<float>((2 + w * 5) / (1 + w)));
}

TEST(Layers, EmptyBinsAreNanWithCountZero) {
  const WeightedMeanAccumulator bins = accumulated(three_by_three(), {{}});
  const BinIndex empty{0, 2};
  const auto zero = [](double, double) { return 0.0; };
  for (const auto& layer :
       {z_est_layer(bins), x_true_layer(bins), y_true_layer(bins), weight_sum_layer(bins),
        z_true_layer(bins, zero, TruthAt::bin_center), z_true_layer(bins, zero, TruthAt::centroid)}) {
    EXPECT_TRUE(std::isnan(layer.at(empty)));
    EXPECT_FALSE(std::isnan(layer.at({1, 1})));
  }
  for (const auto& layer :
       {x_est_mean_layer(bins), y_est_mean_layer(bins), t_mean_layer(bins), z_spread_layer(bins)}) {
    EXPECT_TRUE(std::isnan(layer.at(empty)));
    EXPECT_FALSE(std::isnan(layer.at({1, 1})));
  }
  EXPECT_EQ(count_layer(bins).at(empty), 0);
}

// H(x, y) = 100 x + y tells where it was asked.
TEST(Layers, TruthUnderTheBinsTruePlaceOrAtTheCentroid) {
  const WeightedMeanAccumulator bins =
      accumulated(three_by_three(), {{.x_est = 1.25, .y_est = -0.75, .x_true = 1.375, .y_true = -0.5}});
  const auto where = [](double x, double y) { return 100 * x + y; };
  const BinIndex bin{0, 2};  // centre (1, -1)
  EXPECT_EQ(z_true_layer(bins, where, TruthAt::bin_center).at(bin), 100 * (1 + 0.125) + (-1 + 0.25));
  EXPECT_EQ(z_true_layer(bins, where, TruthAt::centroid).at(bin), 100 * 1.375 - 0.5);
}

TEST(Layers, TruthOffTheTerrainIsNan) {
  const TriangulatedGrid terrain{Grid<double>(GridSpec::centered(1, 1))};
  const WeightedMeanAccumulator bins =
      accumulated(three_by_three(), {{.x_est = 1, .x_true = 1.25}, {.x_est = -1, .x_true = -1}});
  const auto z_true = z_true_layer(
      bins, [&](double x, double y) { return terrain.elevation(x, y); }, TruthAt::bin_center);
  EXPECT_TRUE(std::isnan(z_true.at({1, 2})));
  EXPECT_EQ(z_true.at({1, 0}), 0);
}

// On a tilted plane without errors the estimate is the plane at the weighted centroid, D from the bin's
// centre: e_z = z_true - z_est is -g . D for the centre's truth, and 0 for the centroid's.
TEST(Layers, TiltedPlaneErrorInClosedForm) {
  constexpr double kSlopeX = 0.5;
  constexpr double kSlopeY = -0.25;
  const auto plane = [](double x, double y) { return 2 + kSlopeX * x + kSlopeY * y; };
  std::vector<ReturnPoint> points;
  for (double x = -1.4; x < 1.4; x += 0.17)
    for (double y = -1.4; y < 1.4; y += 0.23)
      points.push_back({.x_est = x, .y_est = y, .z_est = plane(x, y), .x_true = x, .y_true = y});
  const WeightedMeanAccumulator bins = accumulated(three_by_three(), points);
  const auto z_est = z_est_layer(bins);
  const auto x_mean = x_true_layer(bins);
  const auto y_mean = y_true_layer(bins);
  const auto center = z_true_layer(bins, plane, TruthAt::bin_center);
  const auto centroid = z_true_layer(bins, plane, TruthAt::centroid);
  double largest = 0;
  for (const auto [row, col] : Bins({0, 0}, {3, 3})) {
    const BinIndex bin{row, col};
    const double d_x = x_mean.at(bin) - bins.spec().x(col);
    const double d_y = y_mean.at(bin) - bins.spec().y(row);
    EXPECT_NEAR(center.at(bin) - z_est.at(bin), -(kSlopeX * d_x + kSlopeY * d_y), 1e-14);
    EXPECT_NEAR(centroid.at(bin) - z_est.at(bin), 0, 1e-14);
    largest = std::max(largest, std::abs(d_x) + std::abs(d_y));
  }
  EXPECT_GT(largest, 0.01);
}

// A navigation error moves the estimate, not the truth: flat in x, the truth's place moves with dx.
TEST(Layers, TruthFollowsAConstantPositionError) {
  const auto plane = [](double x, double) { return 0.5 * x; };
  std::vector<ReturnPoint> points;
  for (double x = -0.4; x < 0.45; x += 0.1)
    points.push_back({.x_est = x, .z_est = plane(x + 3, 0), .x_true = x + 3});
  const WeightedMeanAccumulator bins = accumulated(three_by_three(), points);
  EXPECT_NEAR(z_true_layer(bins, plane, TruthAt::bin_center).at({1, 1}), 1.5, 1e-14);
  EXPECT_NEAR(z_est_layer(bins).at({1, 1}), 1.5, 1e-14);  // the points lie symmetrically
}

TEST(Layers, SpreadByHand) {
  // Equal weights: 1, 3 -> mean 2, deviation 1. Weights 1 and 0.75: variance w1 w2 / (w1 + w2)^2 d^2.
  EXPECT_EQ(z_spread_layer(accumulated(three_by_three(), {{.z_est = 1}, {.z_est = 3}})).at({1, 1}), 1);
  const WeightedMeanAccumulator unequal =
      accumulated(three_by_three(), {{.z_est = 1}, {.x_est = 0.25, .z_est = 3}});
  EXPECT_FLOAT_EQ(z_spread_layer(unequal).at({1, 1}), static_cast<float>(2 * std::sqrt(0.75) / 1.75));
  EXPECT_EQ(z_spread_layer(accumulated(three_by_three(), {{.z_est = 5}})).at({1, 1}), 0);
}

// Millimetres on top of a million metres: sums of squares of z itself would lose them.
TEST(Layers, SpreadSurvivesALargeOffset) {
  const WeightedMeanAccumulator bins = accumulated(
      three_by_three(), {{.z_est = 1e6}, {.z_est = 1e6 + 0x1p-9}, {.z_est = 1e6}, {.z_est = 1e6 + 0x1p-9}});
  EXPECT_EQ(z_spread_layer(bins).at({1, 1}), 0x1p-10F);
  EXPECT_EQ(z_est_layer(bins).at({1, 1}), 1e6 + 0x1p-10);
}

TEST(Layers, EqualElevationsAreExact) {
  const double z = 0.1;
  const WeightedMeanAccumulator bins =
      accumulated(three_by_three(),
                  {{.x_est = 0.1, .z_est = z}, {.x_est = 0.3, .z_est = z}, {.y_est = -0.4, .z_est = z}});
  EXPECT_EQ(z_est_layer(bins).at({1, 1}), z);
  EXPECT_EQ(z_spread_layer(bins).at({1, 1}), 0);
}

}  // namespace
}  // namespace landfall
