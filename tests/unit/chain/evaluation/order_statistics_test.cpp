// SPDX-License-Identifier: GPL-3.0-or-later
// Sums and quantiles of many values: against a sort, over several pieces, at several numbers of threads.
#include "chain/evaluation/quantile/order_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/numerics/random.h"
#include "chain/evaluation/piecewise.h"
#include "constants.h"

namespace landfall {
namespace {

auto at(const std::vector<double>& values) {
  return [&values](std::size_t i) { return values[i]; };
}

std::optional<double> quantile(const std::vector<double>& values, double q) {
  return quantile_of(values.size(), at(values), q);
}

std::vector<double> noise(std::size_t count, double nan_frac) {
  const RandomField normal(3, RandomStream::range_noise);
  const RandomField uniform(3, RandomStream::dropout);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = uniform.uniform(i) < nan_frac ? kNan : normal.normal(i);
  return values;
}

/// By the definition in quantile.h.
double by_sorting(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  std::ranges::sort(values);
  const double h = static_cast<double>(values.size() - 1) * q;
  const auto below = static_cast<std::size_t>(h);
  const double frac = h - std::floor(h);
  return frac == 0 ? values[below] : values[below] + frac * (values[below + 1] - values[below]);
}

TEST(QuantileOf, SeveralPiecesAsSorted) {
  const std::vector<double> values = noise(3 * kValuesPerPiece + 17, 0.1);
  for (const double q : {0.0, 1e-7, 0.05, 0.5, 0.9, 0.95, 0.9999999, 1.0})
    for (const std::size_t threads : {1U, 2U, 7U}) {
      const ThreadLimit limit(threads);
      EXPECT_EQ(quantile(values, q), by_sorting(values, q)) << q << ", " << threads << " threads";
    }
}

TEST(QuantileOf, TheLastPieceIsFullOrHoldsOneValue) {
  for (const std::size_t more : {0U, 1U}) {
    std::vector<double> values(kValuesPerPiece + more, kNan);
    values.front() = 4;
    values[kValuesPerPiece - 1] = -1;
    values.back() = 2;
    EXPECT_EQ(quantile(values, 0.75), by_sorting(values, 0.75));
    const ValueSummary summary = summarize(values.size(), at(values), 1.5);
    EXPECT_EQ(summary.sum.count, more == 0 ? 2 : 3);
    EXPECT_EQ(summary.sum.sum, more == 0 ? 6 : 5);
    EXPECT_EQ(summary.largest, 4);
    EXPECT_EQ(summary.above, 2);
    EXPECT_EQ(summary.counts[ValueBucket::of(2)], 1U);
    EXPECT_EQ(summary.counts.back(), kValuesPerPiece - 2);
    EXPECT_EQ(counted_sum(values.size(), at(values)).sum, summary.sum.sum);
  }
}

TEST(QuantileOf, FewValuesOfAnySize) {
  const std::vector<double> values{-kInfinity, -1e300, -2, -1e-310, 0, kNan, 1e-310, 1, 1e300, kInfinity};
  for (int step = 0; step <= 8; ++step)
    EXPECT_EQ(quantile(values, step / 8.0), by_sorting(values, step / 8.0)) << step;
  EXPECT_EQ(quantile({1, 2}, 0.25), 1.25);  // two buckets
  EXPECT_EQ(quantile({7, kNan}, 0.95), 7);
}

TEST(QuantileOf, EqualValuesAndZeros) {
  EXPECT_EQ(quantile(std::vector<double>(1000, 0.1), 0.95), 0.1);
  const std::optional<double> zero = quantile({-0.0, -0.0, -0.0}, 0.5);
  ASSERT_TRUE(zero);
  EXPECT_FALSE(std::signbit(*zero));
}

TEST(ValueBucket, OfMagnitudes) {
  for (const double value : {0.0, 1e-310, 0.03, 1.0, 3.5, 1e300, kInfinity}) {
    EXPECT_EQ(ValueBucket::of_magnitude(ValueBucket::of(value)), ValueBucket::of(value)) << value;
    EXPECT_EQ(ValueBucket::of_magnitude(ValueBucket::of(-value)), ValueBucket::of(value)) << value;
  }
  EXPECT_EQ(ValueBucket::of_magnitude(ValueBucket::of(kNan)), ValueBucket::kCount);
}

// Values 0, 0, 1, 1, 1, 4 in the buckets of 0, 1 and 4.
TEST(FindBuckets, ThoseOfTheTwoOrderStatistics) {
  BucketCounts counts(ValueBucket::kCount + 1);
  counts[ValueBucket::of(0)] = 2;
  counts[ValueBucket::of(1)] = 3;
  counts[ValueBucket::of(4)] = 1;
  counts.back() = 7;  // NaN
  const auto expect = [&](double q, double first, double last, std::size_t below) {
    const BucketRange range = find_buckets(counts, q).value();
    EXPECT_EQ(range.first, ValueBucket::of(first)) << q;
    EXPECT_EQ(range.last, ValueBucket::of(last)) << q;
    EXPECT_EQ(range.rank.below, below) << q;
  };
  expect(0, 0, 0, 0);
  expect(0.1, 0, 0, 0);   // h = 0.5
  expect(0.2, 0, 0, 1);   // h = 1
  expect(0.25, 0, 1, 1);  // h = 1.25
  expect(0.4, 1, 1, 0);   // h = 2
  expect(0.7, 1, 1, 1);   // h = 3.5
  expect(0.9, 1, 4, 2);   // h = 4.5
  expect(1, 4, 4, 0);
}

TEST(QuantileOf, NothingWithoutAValue) {
  EXPECT_EQ(quantile({}, 0.5), std::nullopt);
  EXPECT_EQ(quantile({kNan, -kNan}, 0.5), std::nullopt);
}

TEST(CountedSum, PieceByPieceInAFixedOrder) {
  const std::vector<double> values = noise(2 * kValuesPerPiece + 5, 0.1);
  double expected = 0;
  std::int64_t count = 0;
  for (std::size_t begin = 0; begin < values.size(); begin += kValuesPerPiece) {
    double piece = 0;
    for (std::size_t i = begin; i < std::min(begin + kValuesPerPiece, values.size()); ++i) {
      if (std::isnan(values[i])) continue;
      piece += values[i];
      ++count;
    }
    expected += piece;
  }
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    const CountedSum sum = counted_sum(values.size(), at(values));
    EXPECT_EQ(sum.sum, expected);
    EXPECT_EQ(sum.count, count);
  }
  EXPECT_TRUE(std::isnan(counted_sum(0, at(values)).mean()));
}

TEST(ValueSummary, SumOfValuesButLargestAndAboveOfMagnitudes) {
  const std::vector<double> values{kNan, -3, 2, 2, kNan};
  const ValueSummary summary = summarize(values.size(), at(values), 2);
  EXPECT_EQ(summary.sum.count, 3);
  EXPECT_EQ(summary.sum.sum, 1);
  EXPECT_EQ(summary.largest, 3);
  EXPECT_EQ(summary.above, 1);
  EXPECT_EQ(summary.counts[ValueBucket::of(3)], 1U);
  EXPECT_EQ(summary.counts[ValueBucket::of(2)], 2U);
  EXPECT_EQ(summary.counts[ValueBucket::kCount], 2U);
  EXPECT_EQ(summarize(values.size(), at(values), 1.5).above, 3);
  EXPECT_EQ(summarize(1, at(values), 2).largest, -kInfinity);
}

}  // namespace
}  // namespace landfall
