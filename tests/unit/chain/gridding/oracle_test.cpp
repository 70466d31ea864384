// SPDX-License-Identifier: GPL-3.0-or-later
// The accumulator against a slow, obvious one, and against itself at other thread counts and batch sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/core/parallel.h"
#include "map_layers.h"
#include "random_returns.h"
#include "return_columns.h"

namespace landfall {
namespace {

TEST(WeightedMeanAccumulator, AgreesWithTheSlowOne) {
  const GridSpec spec = GridSpec::centered(3, 0.25);
  std::vector<ReturnPoint> points = random_points(spec, 2000);  // about 3 per bin, some empty
  for (ReturnPoint& p : points) p.z_est = 100 + 1.1 * p.x_est - 0.3 * p.y_est;
  const WeightedMeanAccumulator bins = accumulated(spec, points);
  const Members expected = members_of(Method::bilinear_nearest, spec, points);
  const auto z_est = z_est_layer(bins);
  const auto x_true = x_true_layer(bins);
  const auto y_true = y_true_layer(bins);
  const auto weight_sum = weight_sum_layer(bins);
  const auto count = count_layer(bins);
  const auto x_mean = x_est_mean_layer(bins);
  const auto y_mean = y_est_mean_layer(bins);
  const auto t_mean = t_mean_layer(bins);
  const auto spread = z_spread_layer(bins);
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
      const std::vector<Member>& in = found->second;
      inside += static_cast<std::int64_t>(in.size());
      const double z = mean(in, [](const auto& p) { return p.z_est; });
      EXPECT_EQ(count.at(bin), static_cast<std::int32_t>(in.size()));
      EXPECT_NEAR(z_est.at(bin), z, 1e-12);
      EXPECT_NEAR(x_true.at(bin), mean(in, [](const auto& p) { return p.x_true; }), 1e-13);
      EXPECT_NEAR(y_true.at(bin), mean(in, [](const auto& p) { return p.y_true; }), 1e-13);
      EXPECT_NEAR(x_mean.at(bin), mean(in, [](const auto& p) { return p.x_est; }), 1e-6);
      EXPECT_NEAR(y_mean.at(bin), mean(in, [](const auto& p) { return p.y_est; }), 1e-6);
      EXPECT_NEAR(t_mean.at(bin), mean(in, [](const auto& p) { return p.t; }), 1e-6);
      const double variance = mean(in, [&](const auto& p) { return (p.z_est - z) * (p.z_est - z); });
      EXPECT_NEAR(spread.at(bin), std::sqrt(variance), 1e-7);
      double weights = 0;
      for (const Member& w : in) weights += w.weight;
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
  const ReturnColumns columns(random_points(spec, 200'000));
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
