// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/bucket_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "base/numerics/random.h"

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
