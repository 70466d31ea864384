// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/report_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "base/core/parallel.h"
#include "constants.h"

namespace landfall::html_report {
namespace {

using testing::ElementsAre;
using testing::IsNan;

Grid<double> grid_of(std::int64_t rows, std::int64_t cols, const std::vector<double>& values) {
  Grid<double> grid({1, 0, 0, rows, cols});
  std::copy(values.begin(), values.end(), grid.values().begin());
  return grid;
}

TEST(ReductionFactor, IsTheLeastThatFits) {
  EXPECT_EQ(reduction_factor({0.05, 0, 0, 2001, 2001}, 1024), 2);
  EXPECT_EQ(reduction_factor({0.05, 0, 0, 1024, 3}, 1024), 1);
  EXPECT_EQ(reduction_factor({0.05, 0, 0, 3, 1025}, 1024), 2);
  EXPECT_EQ(reduction_factor({0.05, 0, 0, 1, 1}, 1024), 1);
}

// Blocks of 2 x 2, the last column cut short.
TEST(Reduce, FollowsItsRule) {
  const Grid<double> grid = grid_of(2, 3,
                                    {1, -4, kNan,  //
                                     2, 3, 5});
  EXPECT_THAT(reduce(grid, 2, Rule::mean).cells, ElementsAre(0.5, 5));
  EXPECT_THAT(reduce(grid, 2, Rule::extreme).cells, ElementsAre(-4, 5));
  EXPECT_THAT(reduce(grid, 2, Rule::largest).cells, ElementsAre(3, 5));
  EXPECT_THAT(reduce(grid, 2, Rule::least).cells, ElementsAre(-4, 5));
  const ReducedMap map = reduce(grid, 2, Rule::mean);
  EXPECT_EQ(map.rows, 1);
  EXPECT_EQ(map.cols, 2);
}

TEST(Reduce, LosesNoBit) {
  Grid<std::int8_t> grid({1, 0, 0, 2, 2});
  grid.at({0, 1}) = 4;
  grid.at({1, 0}) = 32;
  EXPECT_THAT(reduce(grid, 2, Rule::any_bit).cells, ElementsAre(36));
}

TEST(Reduce, IsNanOnlyWithoutAValue) {
  EXPECT_THAT(reduce(grid_of(1, 2, {kNan, kNan}), 2, Rule::largest).cells, ElementsAre(IsNan()));
  EXPECT_THAT(reduce(grid_of(1, 2, {kNan, 2}), 2, Rule::mean).cells, ElementsAre(2));
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(reduce(grid_of(1, 2, {infinite, 2}), 2, Rule::largest).cells, ElementsAre(2));
}

TEST(Reduce, TakesThePositiveOfTwoEqualMagnitudes) {
  EXPECT_THAT(reduce(grid_of(1, 2, {-3, 3}), 2, Rule::extreme).cells, ElementsAre(3));
  EXPECT_THAT(reduce(grid_of(1, 2, {3, -3}), 2, Rule::extreme).cells, ElementsAre(3));
}

TEST(Reduce, IsTheSameForAnyNumberOfThreads) {
  Grid<double> grid({1, 0, 0, 301, 207});
  std::mt19937 generator(11);
  for (double& value : grid.values()) value = std::normal_distribution<double>()(generator);
  const auto with = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return reduce(grid, 4, Rule::mean).cells;
  };
  EXPECT_EQ(with(1), with(4));
}

}  // namespace
}  // namespace landfall::html_report
