// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/evaluation_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/core/parallel.h"
#include "constants.h"

namespace landfall::html_report {
namespace {

using testing::ElementsAre;

Grid<double> row_of(const std::vector<double>& values) {
  Grid<double> grid({1, 0, 0, 1, static_cast<std::int64_t>(values.size())});
  std::ranges::copy(values, grid.values().begin());
  return grid;
}

TEST(Histogram, CountsTheValuesOfTheRegion) {
  const Grid<double> values = row_of({0, 0.9, 1, 4, kNan, 100});
  BinMask region(values.spec(), 1);
  region.values()[5] = 0;
  const Histogram found = histogram(values, region, 4);
  EXPECT_EQ(found.low, 0);
  EXPECT_EQ(found.high, 4);
  EXPECT_THAT(found.count, ElementsAre(2, 1, 0, 1));  // the greatest value is in the last class
}

TEST(Histogram, HasOneClassForOneValueAndNoneForNone) {
  const Grid<double> same = row_of({3, 3});
  EXPECT_THAT(histogram(same, BinMask(same.spec(), 1), 10).count, ElementsAre(2));
  EXPECT_TRUE(histogram(same, BinMask(same.spec(), 0), 10).count.empty());
  const Grid<double> none = row_of({kNan, kNan});
  EXPECT_TRUE(histogram(none, BinMask(none.spec(), 1), 10).count.empty());
}

TEST(Histogram, IsTheSameForAnyNumberOfThreads) {
  Grid<float> values({1, 0, 0, 900, 700});
  for (std::size_t i = 0; i < values.values().size(); ++i)
    values.values()[i] = static_cast<float>(i * 2654435761U % 100003U);
  const BinMask region(values.spec(), 1);
  const auto with = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return histogram(values, region, 100).count;
  };
  const std::vector<std::int64_t> one = with(1);
  EXPECT_EQ(one, with(4));
  EXPECT_EQ(std::accumulate(one.begin(), one.end(), std::int64_t{0}), 630000);
}

}  // namespace
}  // namespace landfall::html_report
