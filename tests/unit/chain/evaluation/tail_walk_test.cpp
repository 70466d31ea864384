// SPDX-License-Identifier: GPL-3.0-or-later
// One walk over a tile's windows against a sort in each window.
#include "chain/evaluation/quantile/tail_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/numerics/random.h"
#include "chain/evaluation/quantile/quantile.h"
#include "constants.h"

namespace landfall {
namespace {

constexpr Tile kTile{4, 3, 9, 11};

/// Noise with some empty bins, everywhere in the region but for one bin of the tile.
class TailWalkTest : public testing::TestWithParam<double> {
 protected:
  TailWalkTest() {
    const RandomField draw(12, RandomStream::range_noise);
    for (std::size_t i = 0; i < error_.spec().size(); ++i)
      error_.values()[i] = i % 17 == 3 ? kNan : draw.normal(i) + 0.3;
    region_.at({6, 6}) = 0;
  }

  /// Sorted |error - mean| of a window.
  [[nodiscard]] std::vector<double> deviations(BinIndex bin, const WindowMeans& windows,
                                               const Footprint& footprint) const {
    std::vector<double> found;
    for (std::int64_t row = 0; row < error_.spec().rows; ++row)
      for (std::int64_t col = 0; col < error_.spec().cols; ++col) {
        const std::int64_t up = row - bin.row;
        if (std::abs(up) > footprint.half_bins() || std::abs(col - bin.col) > footprint.half_width(up))
          continue;
        const double deviation = std::abs(error_.at({row, col}) - windows.mean.at(bin));
        if (!std::isnan(deviation)) found.push_back(deviation);
      }
    std::ranges::sort(found);
    return found;
  }

  /// A walk from `floor`, with the tails that it asks for. Returns the smallest of what it found.
  double expect_as_sorted(double floor, const Footprint& footprint, double q) const;

  Grid<double> error_{GridSpec{1, 0, 0, 16, 19}};
  BinMask region_{GridSpec{1, 0, 0, 16, 19}, 1};
};

double TailWalkTest::expect_as_sorted(double floor, const Footprint& footprint, double q) const {
  const WindowMeans windows = window_means(error_, footprint);
  const WindowQuantileInput input{
      .error = error_, .windows = windows, .footprint = footprint, .region = region_, .quantile = q};
  double lowest = kInfinity;
  double highest = -kInfinity;
  for (std::int64_t row = 0; row < kTile.rows; ++row)
    for (std::int64_t col = 0; col < kTile.cols; ++col) {
      const double mean = windows.mean.at({kTile.first_row + row, kTile.first_col + col});
      lowest = std::min(lowest, mean);
      highest = std::max(highest, mean);
    }
  ErrorTails tails;
  collect_tails(error_, reach(error_.spec(), kTile, footprint.half_bins()), {lowest + floor, highest - floor},
                tails);
  tails.upper.build(kTile, footprint);
  tails.lower.build(kTile, footprint);
  Grid<double> result(error_.spec(), kNan);
  const WalkOutcome outcome = TailWalk(input, result).run(tails, kTile, floor);

  std::int64_t uncertified = 0;
  double smallest = kInfinity;
  for (std::int64_t row = 0; row < error_.spec().rows; ++row)
    for (std::int64_t col = 0; col < error_.spec().cols; ++col) {
      const BinIndex bin{row, col};
      const bool in_tile = row >= kTile.first_row && row < kTile.first_row + kTile.rows &&
                           col >= kTile.first_col && col < kTile.first_col + kTile.cols;
      if (!in_tile || region_.at(bin) == 0) {
        EXPECT_TRUE(std::isnan(result.at(bin)));
        continue;
      }
      const std::vector<double> sorted = deviations(bin, windows, footprint);
      const QuantileRank rank = quantile_rank(sorted.size(), q);
      const double below = sorted[rank.below];
      if (below >= floor) {
        smallest = std::min(smallest, below);
        EXPECT_EQ(result.at(bin),
                  rank.frac == 0 ? below : below + rank.frac * (sorted[rank.below + 1] - below));
      } else {
        ++uncertified;
        EXPECT_TRUE(std::isnan(result.at(bin)));
        EXPECT_LE(outcome.lower_bound, below);
      }
    }
  EXPECT_EQ(outcome.uncertified, uncertified);
  EXPECT_EQ(outcome.smallest, smallest);
  if (uncertified == 0) {
    EXPECT_EQ(outcome.lower_bound, kInfinity);
  }
  return smallest;
}

TEST_P(TailWalkTest, FindsAllThatLieAboveItsFloor) {
  for (const Footprint& footprint : {Footprint::square(3), Footprint::disc(13)})
    for (const double q : {0.0, 0.6, 0.95, 1.0}) expect_as_sorted(GetParam(), footprint, q);
}

INSTANTIATE_TEST_SUITE_P(Floors, TailWalkTest, testing::Values(0, 0.9, 1.8, 2.1, 9));

// A value at the floor is found, too.
TEST_F(TailWalkTest, FindsWhatLiesAtItsFloor) {
  for (const Footprint& footprint : {Footprint::square(3), Footprint::disc(13)}) {
    const double smallest = expect_as_sorted(0, footprint, 0.9);
    EXPECT_EQ(expect_as_sorted(smallest, footprint, 0.9), smallest);
  }
}

// Tails that hold every bin, in steps of one window: a rank that jumps from window to window.
TEST_F(TailWalkTest, FollowsMeansThatJump) {
  for (std::int64_t row = 0; row < error_.spec().rows; ++row)
    for (std::int64_t col = 0; col < error_.spec().cols; ++col)
      if ((row / 3 + col / 4) % 3 == 0) error_.at({row, col}) = (row + col) % 2 == 0 ? 50.0 : kNan;
  for (const double q : {0.1, 0.5, 0.95}) {
    expect_as_sorted(0, Footprint::square(4), q);
    expect_as_sorted(0, Footprint::disc(8), q);
  }
}

}  // namespace
}  // namespace landfall
