// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/numerics/random.h"
#include "bins.h"
#include "chain/evaluation/judge/window_judge.h"
#include "chain/evaluation/quantile/quantile.h"
#include "chain/evaluation/quantile/tail_walk.h"
#include "constants.h"

namespace landfall {
namespace {

// The parts of decide(): box sums, counts that decide, errors of a tile.
template <class T>
View<T> view(std::vector<T>& values, std::int64_t cols) {
  return {values.data(), cols, static_cast<std::int64_t>(values.size()) / cols, cols};
}

TEST(WindowSums, EqualTheSumsOfEachWindow) {
  const RandomField draw(4, RandomStream::fractal);
  for (const Footprint& footprint :
       {Footprint::square(0), Footprint::square(1), Footprint::square(3), Footprint::square(17),
        Footprint::disc(0), Footprint::disc(10), Footprint::disc(289)}) {
    const std::int64_t half = footprint.half_bins();
    for (const std::int64_t half_cols : {half, half / 2}) {
      constexpr std::int64_t kRows = 5;
      constexpr std::int64_t kCols = 11;
      const std::int64_t cols = kCols + 2 * half_cols;
      std::vector<std::uint64_t> values(static_cast<std::size_t>((kRows + 2 * half) * cols));
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<std::uint64_t>(100 * draw.uniform(i));
      std::vector<double> doubles(values.begin(), values.end());
      std::vector<std::uint64_t> sums(kRows * kCols, 7);
      std::vector<double> sums_of_doubles(kRows * kCols, 7);
      window_sums(view(values, cols), footprint, view(sums, kCols));
      window_sums(view(doubles, cols), footprint, view(sums_of_doubles, kCols));
      for (const auto [row, col] : Bins({0, 0}, {kRows, kCols})) {
        std::uint64_t sum = 0;
        for (std::int64_t i = -half; i <= half; ++i) {
          const std::int64_t width = std::min(footprint.half_width(i), half_cols);
          for (std::int64_t j = -width; j <= width; ++j)
            sum += view(values, cols).at(row + half + i, col + half_cols + j);
        }
        EXPECT_EQ(view(sums, kCols).at(row, col), sum);
        EXPECT_EQ(view(sums_of_doubles, kCols).at(row, col), static_cast<double>(sum));
      }
    }
  }
}

// n values of which k exceed the limit: the bounds must agree with the quantile of any such values.
TEST(DecisiveCounts, AgreeWithTheQuantile) {
  for (const double q : {0.0, 0.3, 0.5, 0.75, 0.95, 0.999, 1.0}) {
    for (std::int64_t n = 1; n <= 41; ++n) {
      const DecisiveCounts counts = DecisiveCounts::of(n, q);
      EXPECT_LE(counts.fail - counts.pass, 2);
      for (std::int64_t k = 0; k <= n; ++k) {
        // The others equal the limit 1; these exceed it as little as possible.
        std::vector<double> values(static_cast<std::size_t>(n), 1.0);
        std::fill_n(values.begin(), k, std::nextafter(1, 2));
        const bool small_exceeds = quantile_in_place(values, q) > 1;
        // The others are far below the limit, or these are far above it.
        std::fill_n(values.begin(), n, 0.0);
        std::fill_n(values.begin(), k, 1e9);
        const bool large_exceeds = quantile_in_place(values, q) > 1;
        SCOPED_TRACE(testing::Message() << k << " of " << n << " exceed, quantile " << q);
        if (k <= counts.pass) {
          EXPECT_FALSE(small_exceeds || large_exceeds);
        } else if (k >= counts.fail) {
          EXPECT_TRUE(small_exceeds && large_exceeds);
        } else {
          EXPECT_GT(quantile_rank(static_cast<std::size_t>(n), q).frac, 0);
        }
      }
    }
  }
}

TEST(CountDeviations, AboutAllMeansOrSome) {
  std::vector<double> errors{kNan, 0, 0.5, 1, 1.5, 2, 2.5, -0.5, -1, -1.5, -2};
  std::vector<std::uint64_t> packed(errors.size());
  const DeviationTotals totals = count_deviations(view(errors, 11), {-0.5, 0.5}, 1, view(packed, 11));
  // Some: e > 0.5 or e < -0.5; all: e > 1.5 or e < -1.5.
  const std::vector<int> possible{0, 0, 0, 1, 1, 1, 1, 0, 1, 1, 1};
  const std::vector<int> certain{0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1};
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const PackedCounts counts{packed[i]};
    EXPECT_EQ(counts.valid(), i == 0 ? 0 : 1);
    EXPECT_EQ(counts.possible(), possible[i]) << i;
    EXPECT_EQ(counts.certain(), certain[i]) << i;
  }
  EXPECT_EQ(totals.possible, 7);
  EXPECT_EQ(totals.certain, 3);
}

DemLayers small_dem() {
  const GridSpec spec{1, -2, -3, 5, 13};
  DemLayers dem{Grid<double>(spec, 1),
                TrueLayers{Grid<double>(spec), Grid<double>(spec), Grid<double>(spec)}};
  for (std::size_t i = 0; i < spec.size(); ++i) dem.truth->z.values()[i] = static_cast<double>(i);
  dem.truth->z.at({1, 12}) = kNan;
  return dem;
}

TEST(TileErrors, AreThoseOfTheAxisAndNanBeyondTheGrid) {
  const DemLayers dem = small_dem();
  const Footprint footprint = Footprint::square(2);
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    const Grid<double> expected = error_of(axis,
                                           axis == Axis::x   ? dem.truth->x
                                           : axis == Axis::y ? dem.truth->y
                                                             : dem.truth->z,
                                           dem.z_est);
    TileErrors errors(axis, dem, footprint);
    errors.load({1, 4, 4, 9});
    const View<const double> found = errors.errors();
    ASSERT_EQ(found.rows, 8);
    ASSERT_EQ(found.cols, 13);
    std::int64_t valid = 0;
    double lowest = HUGE_VAL;
    for (const auto [row, col] : bins_of(found)) {
      const BinIndex bin{row - 1, col + 2};
      const double e = expected.spec().contains(bin) ? expected.at(bin) : kNan;
      EXPECT_TRUE(found.at(row, col) == e || (std::isnan(found.at(row, col)) && std::isnan(e)));
      EXPECT_EQ(errors.filled().at(row, col), std::isnan(e) ? 0 : e);
      valid += std::isnan(e) ? 0 : 1;
      if (e < lowest) lowest = e;
    }
    EXPECT_EQ(errors.range().valid, valid);
    EXPECT_EQ(errors.missing(), 8 * 13 - valid);
    EXPECT_EQ(errors.range().lowest, lowest);
    EXPECT_FALSE(errors.range().has_infinite);
  }
}

// Each of these decides some windows: noise whose quantiles lie about the limit.
TEST(WindowJudge, EveryStepDecides) {
  const GridSpec spec{1, 0, 0, 64, 64};
  DemLayers dem{Grid<double>(spec), TrueLayers{Grid<double>(spec), Grid<double>(spec), Grid<double>(spec)}};
  const RandomField noise(3, RandomStream::range_noise);
  for (std::size_t i = 0; i < spec.size(); ++i) dem.truth->z.values()[i] = noise.normal(i);
  const Footprint footprint = Footprint::square(5);
  TileErrors errors(Axis::z, dem, footprint);
  errors.load({0, 0, 64, 64});
  WindowJudge judge({footprint, 0.95, 1.96, fail_relative_z});
  const std::vector<std::int8_t> region(spec.size(), 1);
  std::vector<std::int8_t> fail(spec.size());
  const WindowJudge::Outcome outcome =
      judge.judge(errors, {region.data(), 64, 64, 64}, {fail.data(), 64, 64, 64});
  EXPECT_EQ(outcome.footprints, 64 * 64);
  EXPECT_EQ(outcome.violations, std::ranges::count(fail, fail_relative_z));
  EXPECT_GT(outcome.violations, 400);
  EXPECT_LT(outcome.violations, 3600);
  EXPECT_GT(outcome.by_list, 0);
  EXPECT_LT(outcome.by_list, 3600);
  EXPECT_GT(outcome.by_quantile, 0);
  EXPECT_LT(outcome.by_quantile, outcome.by_list);
}

// One walk over a tile's windows against a sort in each window.
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
    for (const auto [row, col] : bins_of(error_.spec())) {
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
  for (const auto [row, col] : bins_of(kTile)) {
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
  for (const auto [row, col] : bins_of(error_.spec())) {
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
  for (const auto [row, col] : bins_of(error_.spec()))
    if ((row / 3 + col / 4) % 3 == 0) error_.at({row, col}) = (row + col) % 2 == 0 ? 50.0 : kNan;
  for (const double q : {0.1, 0.5, 0.95}) {
    expect_as_sorted(0, Footprint::square(4), q);
    expect_as_sorted(0, Footprint::disc(8), q);
  }
}

}  // namespace
}  // namespace landfall
