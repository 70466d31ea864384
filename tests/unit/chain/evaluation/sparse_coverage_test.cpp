// SPDX-License-Identifier: GPL-3.0-or-later
// judge_coverage() against assess_coverage().
#include "chain/evaluation/sparse_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/raster/masks.h"

namespace landfall {
namespace {

void expect_equal(const BinMask& valid, const BinMask& region, const EvaluationLimits& limits) {
  const Coverage dense = assess_coverage(valid, region, limits);
  Grid<std::int8_t> expected(valid.spec(), 1);
  flag_coverage(dense, limits, expected);
  Grid<std::int8_t> fail(valid.spec(), 1);
  const JudgedCoverage judged = judge_coverage(valid, region, limits, fail);
  EXPECT_EQ(judged.metrics, dense.metrics);
  EXPECT_EQ(judged.holes, dense.holes);
  EXPECT_TRUE(std::ranges::equal(fail.values(), expected.values()));
}

BinMask all_except(const BinMask& holes) {
  BinMask valid(holes.spec());
  for (std::size_t i = 0; i < valid.values().size(); ++i) valid.values()[i] = holes.values()[i] != 0 ? 0 : 1;
  return valid;
}

TEST(JudgeCoverage, EqualsTheDenseResult) {
  constexpr GridSpec spec{1, -30, -40, 61, 81};
  for (const double frac : {0.0, 0.001, 0.05, 0.11, 0.2, 0.5, 0.95, 1.0}) {
    const BinMask valid = all_except(testing_masks::random_mask(spec, frac, 3));
    expect_equal(valid, BinMask(spec, 1), {.hole_size = 2, .hole_depth = 0.5});
    expect_equal(valid, circular_region(spec, 25), {.hole_size = 1});
    expect_equal(valid, testing_masks::random_mask(spec, 0.3, 4), {});
  }
}

// A square of 2 half - 1 bins: the centre of the second is too far from a valid bin for the short search.
TEST(JudgeCoverage, SmallAndLargeHoles) {
  constexpr GridSpec spec{1, 0, 0, 90, 90};
  for (const std::int64_t half : {3, 14, 40}) {
    BinMask hole(spec);
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        hole.at({row, col}) = std::max(std::abs(row - 44), std::abs(col - 5)) < half ? 1 : 0;
    expect_equal(all_except(hole), BinMask(spec, 1), {.hole_depth = 4});
  }
}

}  // namespace
}  // namespace landfall
