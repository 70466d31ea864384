// SPDX-License-Identifier: GPL-3.0-or-later
// The accumulator against a slow, obvious one, and against itself at other thread counts and batch sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include "base/core/parallel.h"
#include "map_layers.h"
#include "return_columns.h"
#include "test_seed.h"

namespace landfall {
namespace {

// Random returns, some outside the grid, every tenth on an edge or a centre.
std::vector<ReturnPoint> oracle_points(const GridSpec& spec, std::size_t count) {
  std::mt19937_64 random(test_seed());
  const double reach = spec.x(spec.cols - 1) * 1.1;
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::uniform_real_distribution<double> offset(-0.1, 0.1);
  std::vector<ReturnPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    ReturnPoint& p = points[i];
    p.x_est = coordinate(random);
    p.y_est = coordinate(random);
    if (i % 10 == 0) p.x_est = std::round(p.x_est / spec.resolution_m * 2) / 2 * spec.resolution_m;
    if (i % 20 == 0) p.y_est = std::round(p.y_est / spec.resolution_m * 2) / 2 * spec.resolution_m;
    p.z_est = 100 + p.x_est + offset(random);
    p.x_true = p.x_est + offset(random);
    p.y_true = p.y_est + offset(random);
    p.z_true = p.z_est;
    p.t = static_cast<double>(i) * 1e-3;
  }
  return points;
}

struct Weighted {
  double weight;
  ReturnPoint point;
};

// sum w f / sum w
template <class Value>
double oracle_mean(const std::vector<Weighted>& bin, Value value) {
  double sum = 0;
  double weights = 0;
  for (const Weighted& w : bin) {
    sum += w.weight * value(w.point);
    weights += w.weight;
  }
  return sum / weights;
}

std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Weighted>> binned(
    const GridSpec& spec, const std::vector<ReturnPoint>& points) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Weighted>> bins;
  const double s = spec.resolution_m;
  for (const ReturnPoint& p : points) {
    const double i = std::floor(p.x_est / s + 0.5);
    const double j = std::floor(p.y_est / s + 0.5);
    const std::int64_t col = static_cast<std::int64_t>(i) - spec.first_col;
    const std::int64_t row = static_cast<std::int64_t>(j) - spec.first_row;
    if (row < 0 || row >= spec.rows || col < 0 || col >= spec.cols) continue;
    const double w = (1 - std::abs(p.x_est - i * s) / s) * (1 - std::abs(p.y_est - j * s) / s);
    bins[{row, col}].push_back({w, p});
  }
  return bins;
}

TEST(WeightedMeanAccumulator, AgreesWithTheSlowOne) {
  const GridSpec spec = GridSpec::centered(3, 0.25);
  const std::vector<ReturnPoint> points = oracle_points(spec, 2000);  // about 3 per bin, some empty
  const WeightedMeanAccumulator bins = accumulated(spec, points);
  const auto expected = binned(spec, points);
  const auto z_est = z_est_layer(bins);
  const auto x_true = x_true_layer(bins);
  const auto y_true = y_true_layer(bins);
  const auto weight_sum = weight_sum_layer(bins);
  const auto count = count_layer(bins);
  const auto x_mean = x_est_mean_layer(bins);
  const auto y_mean = y_est_mean_layer(bins);
  const auto t_mean = t_mean_layer(bins);
  const auto z_spread = z_spread_layer(bins);
  ASSERT_LT(expected.size(), spec.size());  // some bins are empty
  std::int64_t inside = 0;
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const auto found = expected.find({row, col});
      const BinIndex bin{row, col};
      if (found == expected.end()) {
        EXPECT_EQ(count.at(bin), 0);
        continue;
      }
      const std::vector<Weighted>& in = found->second;
      inside += static_cast<std::int64_t>(in.size());
      const double z = oracle_mean(in, [](const auto& p) { return p.z_est; });
      EXPECT_EQ(count.at(bin), static_cast<std::int32_t>(in.size()));
      EXPECT_NEAR(z_est.at(bin), z, 1e-12);
      EXPECT_NEAR(x_true.at(bin), oracle_mean(in, [](const auto& p) { return p.x_true; }), 1e-13);
      EXPECT_NEAR(y_true.at(bin), oracle_mean(in, [](const auto& p) { return p.y_true; }), 1e-13);
      EXPECT_NEAR(x_mean.at(bin), oracle_mean(in, [](const auto& p) { return p.x_est; }), 1e-6);
      EXPECT_NEAR(y_mean.at(bin), oracle_mean(in, [](const auto& p) { return p.y_est; }), 1e-6);
      EXPECT_NEAR(t_mean.at(bin), oracle_mean(in, [](const auto& p) { return p.t; }), 1e-6);
      const double variance = oracle_mean(in, [&](const auto& p) { return (p.z_est - z) * (p.z_est - z); });
      EXPECT_NEAR(z_spread.at(bin), std::sqrt(variance), 1e-7);
      double weights = 0;
      for (const Weighted& w : in) weights += w.weight;
      EXPECT_NEAR(weight_sum.at(bin), weights, 1e-12);
    }
  EXPECT_EQ(bins.inside_count(), inside);
  EXPECT_EQ(bins.outside_count(), static_cast<std::int64_t>(points.size()) - inside);
}

WeightedMeanAccumulator in_batches(const GridSpec& spec, const GridPoints& points, std::size_t batch) {
  WeightedMeanAccumulator bins(spec);
  for (std::size_t first = 0; first < points.size(); first += batch)
    bins.add(points.subset(first, std::min(batch, points.size() - first)));
  return bins;
}

bool same_bits(const WeightedMeanAccumulator& a, const WeightedMeanAccumulator& b) {
  return std::memcmp(a.bins().data(), b.bins().data(), a.bins().size_bytes()) == 0 &&
         a.outside_count() == b.outside_count() && a.inside_count() == b.inside_count();
}

TEST(WeightedMeanAccumulator, SameBitsAtAnyThreadCountAndBatchSize) {
  const GridSpec spec = GridSpec::centered(10, 0.25);
  const ReturnColumns columns(oracle_points(spec, 200'000));
  const GridPoints points = columns.view();
  const WeightedMeanAccumulator reference = in_batches(spec, points, points.size());
  for (const std::size_t threads : {1U, 2U, 3U}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(same_bits(in_batches(spec, points, points.size()), reference)) << threads << " threads";
    EXPECT_TRUE(same_bits(in_batches(spec, points, 70'001), reference)) << threads << " threads";
  }
  const GridPoints few = points.subset(0, 5000);
  const WeightedMeanAccumulator reference_of_few = in_batches(spec, few, few.size());
  EXPECT_TRUE(same_bits(in_batches(spec, few, 1), reference_of_few));
  EXPECT_TRUE(same_bits(in_batches(spec, few, 7), reference_of_few));
  EXPECT_FALSE(same_bits(reference, reference_of_few));
}

// A coarse wide bin filled over four million returns: a batch longer than one pass of the accumulator.
TEST(WeightedMeanAccumulator, LongBatchesAreCutWithoutLoss) {
  constexpr std::size_t kPoints = (std::size_t{1} << 22U) + 12'345;
  const std::vector<double> zeros(kPoints, 0.0);
  const std::vector<double> ones(kPoints, 1.0);
  WeightedMeanAccumulator bins(GridSpec::centered(1, 1));
  bins.add({zeros, zeros, ones, zeros, zeros, zeros, zeros});
  EXPECT_EQ(bins.inside_count(), static_cast<std::int64_t>(kPoints));
  EXPECT_EQ(bins.bins()[4].count, static_cast<std::int32_t>(kPoints));
  EXPECT_EQ(bins.bins()[4].weight, static_cast<double>(kPoints));
}

}  // namespace
}  // namespace landfall
