// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <tuple>
#include <vector>

#include "base/numerics/random.h"
#include "chain/evaluation/piecewise.h"
#include "chain/evaluation/quantile/bucket_sort.h"
#include "chain/evaluation/quantile/order_statistics.h"
#include "chain/evaluation/quantile/quantile.h"
#include "constants.h"

namespace landfall {
namespace {

// Sums and quantiles of many values: against a sort, over several pieces, at several numbers of threads.
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
  std::vector<double> values{-kInfinity, -1e300, -2, -1e-310, 0, kNan, 1e-310, 1, 1e300, kInfinity};
  for (const std::size_t size : {values.size(), kFewValues, kFewValues + 1}) {  // in one bucket, and in many
    values.resize(size, kNan);
    for (int step = 0; step <= 8; ++step)
      EXPECT_EQ(quantile(values, step / 8.0), by_sorting(values, step / 8.0)) << size << ", " << step;
  }
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
  EXPECT_EQ(summary.counts, (BucketCounts{3, 2}));
  EXPECT_EQ(summarize(values.size(), at(values), 1.5).above, 3);
  EXPECT_EQ(summarize(1, at(values), 2).largest, -kInfinity);
}

std::vector<TailBin> bins_with(const std::vector<double>& values) {
  std::vector<TailBin> bins;
  for (const double value : values) {
    const auto number = static_cast<std::int32_t>(bins.size());
    bins.push_back({value, number, 2 * number});
  }
  return bins;
}

bool by_value_then_row(const TailBin& a, const TailBin& b) {
  return std::tuple(-a.value, a.row) < std::tuple(-b.value, b.row);
}

/// Descending, and the same bins as before; those of one value may stand in any order.
void expect_sorted(const std::vector<double>& values) {
  std::vector<TailBin> expected = bins_with(values);
  std::vector<TailBin> sorted = expected;
  BucketSort().sort(sorted);
  EXPECT_TRUE(std::ranges::is_sorted(sorted, {}, [](const TailBin& bin) { return -bin.value; }));
  std::ranges::sort(sorted, by_value_then_row);
  std::ranges::sort(expected, by_value_then_row);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(sorted[i].value, expected[i].value);
    EXPECT_EQ(sorted[i].row, expected[i].row);
    EXPECT_EQ(sorted[i].col, expected[i].col);
  }
}

std::vector<double> uniform(std::size_t count) {
  const RandomField draw(6, RandomStream::dropout);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = draw.uniform(i) - 0.25;
  return values;
}

TEST(BucketSort, AnyNumberOfBins) {
  for (std::size_t count = 0; count < 70; ++count) expect_sorted(uniform(count));
  expect_sorted(uniform(3000));
}

// Each heap is a thousandth as wide as the one before and lies in one of its buckets: more of them than are
// dealt, one within another.
TEST(BucketSort, HeapsWithinHeaps) {
  std::vector<double> values;
  for (const double width : {1.0, 1e-4, 1e-8, 1e-12, 1e-16, 1e-20})
    for (const double value : uniform(60)) values.push_back(width * value);
  expect_sorted(values);
  std::ranges::reverse(values);
  expect_sorted(values);
}

TEST(BucketSort, EqualValues) {
  expect_sorted(std::vector<double>(100, 0.5));
  std::vector<double> two(100, 1);
  for (std::size_t i = 0; i < two.size(); i += 3) two[i] = 2;
  expect_sorted(two);
}

// The number of bins over their range is infinite, or the range is.
TEST(BucketSort, RangesWithoutAWidth) {
  std::vector<double> close(50, 0.0);
  std::vector<double> far(50, -1.7e308);
  for (std::size_t i = 1; i < close.size(); i += 2) {
    close[i] = std::numeric_limits<double>::denorm_min();
    far[i] = 1.7e308;
  }
  expect_sorted(close);
  expect_sorted(far);
}

// The buckets of one list do not show in the next.
TEST(BucketSort, SortsOneListAfterAnother) {
  BucketSort sort;
  for (const std::size_t count : {500U, 40U, 800U}) {
    std::vector<TailBin> bins = bins_with(uniform(count));
    sort.sort(bins);
    EXPECT_TRUE(std::ranges::is_sorted(bins, {}, [](const TailBin& bin) { return -bin.value; }));
    EXPECT_EQ(bins.size(), count);
  }
}

double quantile_of(std::vector<double> values, double q) { return quantile_in_place(values, q); }

TEST(Quantile, SmallSetsByHand) {
  EXPECT_EQ(quantile_of({7}, 0.95), 7);
  EXPECT_EQ(quantile_of({3, 1}, 0.5), 2);          // h = 0.5
  EXPECT_EQ(quantile_of({4, 1, 3, 2}, 0.5), 2.5);  // h = 1.5
  EXPECT_EQ(quantile_of({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(quantile_of({8, 0, 4}, 0.75), 6);  // h = 1.5, between 4 and 8
  // 21 values 0, 1, .., 20: h = 20 * 0.95 = 19.
  EXPECT_EQ(quantile_of({20, 19, 18, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0}, 0.95),
            19);
}

TEST(Quantile, EndsAreMinimumAndMaximum) {
  EXPECT_EQ(quantile_of({3, 1, 2}, 0), 1);
  EXPECT_EQ(quantile_of({3, 1, 2}, 1), 3);
}

TEST(Quantile, Ties) {
  EXPECT_EQ(quantile_of({2, 2, 2, 2}, 0.95), 2);
  EXPECT_EQ(quantile_of({1, 2, 2, 1}, 0.5), 1.5);
}

TEST(Quantile, NoValueIsNan) { EXPECT_TRUE(std::isnan(quantile_of({}, 0.95))); }

// 35 x 35 bins: h = 1224 * 0.95 = 1162.8.
TEST(QuantileRank, OfAFullFootprint) {
  const QuantileRank rank = quantile_rank(1225, 0.95);
  EXPECT_EQ(rank.below, 1162U);
  EXPECT_NEAR(rank.frac, 0.8, 1e-12);
}

}  // namespace
}  // namespace landfall
