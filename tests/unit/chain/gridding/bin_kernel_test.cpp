// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/bin_kernel.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "base/core/parallel.h"
#include "constants.h"
#include "return_columns.h"
#include "targets.h"

namespace landfall {
namespace {

/// The weight of WeightedMeanAccumulator, by std::floor.
double bilinear_weight(const GridSpec& spec, double x, double y) {
  const double u = x / spec.resolution_m;
  const double v = y / spec.resolution_m;
  return (1 - std::abs(u - std::floor(u + 0.5))) * (1 - std::abs(v - std::floor(v + 0.5)));
}

struct Expected {
  std::vector<BinSums> bins;
  std::size_t outside = 0;
};

/// One return after the other.
Expected one_by_one(const GridPoints& points, const GridSpec& spec, BinWeights weights) {
  Expected expected{std::vector<BinSums>(spec.size()), 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points.x_est[i];
    const double y = points.y_est[i];
    const BinIndex bin = spec.bin_of(x, y);
    if (!spec.contains(bin)) {
      ++expected.outside;
      continue;
    }
    const double weight = weights == BinWeights::equal ? 1 : bilinear_weight(spec, x, y);
    add_return(points, i, weight, expected.bins[spec.index(bin)]);
  }
  return expected;
}

void expect_same_bits(std::span<const BinSums> found, std::span<const BinSums> expected) {
  ASSERT_EQ(found.size(), expected.size());
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const auto member :
         {&BinSums::weight, &BinSums::w_dz, &BinSums::w_dz_dz, &BinSums::w_x_true, &BinSums::w_y_true,
          &BinSums::w_x_est, &BinSums::w_y_est, &BinSums::w_t, &BinSums::z_first})
      ASSERT_EQ(bits(found[i].*member), bits(expected[i].*member)) << "bin " << i;
    ASSERT_EQ(found[i].count, expected[i].count) << "bin " << i;
  }
}

/// Points around the map: at random, on centres and edges, in the bin of the one before, and far away.
ReturnColumns points_around(const GridSpec& spec, std::size_t count) {
  std::mt19937_64 random(11);
  const double reach = 0.6 * static_cast<double>(spec.cols) * spec.resolution_m;
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::uniform_int_distribution<int> kind(0, 7);
  std::uniform_int_distribution<int> halves(-24, 24);
  ReturnColumns columns;
  ReturnPoint p;
  for (std::size_t i = 0; i < count; ++i) {
    const int what = kind(random);
    if (what < 5) p.x_est = coordinate(random);
    if (what < 3 || what == 5) p.y_est = coordinate(random);
    if (what == 6) p.x_est = 0.5 * halves(random) * spec.resolution_m;
    if (i % 997 == 5) p.y_est = i % 2 == 0 ? 1e300 : -3e9;
    p.z_est = 1000 + coordinate(random);
    p.x_true = p.x_est + 1e-3 * coordinate(random);
    p.y_true = p.y_est + 1e-3 * coordinate(random);
    p.t = 1e-4 * static_cast<double>(i);
    columns.push_back(p);
  }
  return columns;
}

void expect_same_bits_as_one_by_one() {
  for (const GridSpec& spec : {GridSpec::centered(1, 0.1), GridSpec{0.3, -5, 4, 9, 17}}) {
    for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 127U, 128U, 129U, 5000U}) {
      const ReturnColumns columns = points_around(spec, count);
      for (const BinWeights weights : {BinWeights::bilinear, BinWeights::equal}) {
        const Expected expected = one_by_one(columns.view(), spec, weights);
        std::vector<BinSums> bins(spec.size());
        EXPECT_EQ(add_returns(columns.view(), spec, weights, bins), expected.outside);
        expect_same_bits(bins, expected.bins);
      }
    }
  }
}

TEST(BinKernel, SameBitsAsOneByOne) { on_every_target(expect_same_bits_as_one_by_one); }

/// `parts` of `all`, which are added one after another.
template <class View>
void expect_same_bits_with_threads(const GridSpec& spec, BinWeights weights, const View& all,
                                   std::initializer_list<View> parts) {
  const Expected expected = one_by_one(all, spec, weights);
  for (const std::size_t threads : {1U, 2U, 3U, 7U}) {
    const ThreadLimit limit(threads);
    WeightedMeanAccumulator bins(spec, weights);
    for (const View& part : parts) bins.add(part);
    expect_same_bits(bins.bins(), expected.bins);
    EXPECT_EQ(static_cast<std::size_t>(bins.outside_count()), expected.outside);
  }
}

TEST(BinKernel, AccumulatorHasTheSameBitsWithThreads) {
  const GridSpec spec = GridSpec::centered(3, 0.1);
  const ReturnColumns columns = points_around(spec, 150'000);  // several pieces of a partition
  expect_same_bits_with_threads(spec, BinWeights::bilinear, columns.view(), {columns.view()});
}

// Lines of images of 18 x 18 points, as a scanner makes them: runs long and short, bins seen by several
// lines.
TEST(BinKernel, ScansHaveTheSameBitsWithThreads) {
  const GridSpec spec = GridSpec::centered(30, 0.1);
  ReturnColumns columns;
  for (int i = 0; i < 100'000; ++i) {
    const int pulse = i / 324;
    const double x = -31 + 0.6 * (pulse % 103) + 0.0503 * (i % 18);
    const double y = 5 - 0.5 * (pulse / 103) + 0.0497 * (i % 324 / 18);
    columns.push_back({x, y, 0.1 * x * y, x + 0.01, y - 0.01, 0.1 * x, 1e-4 * i});
  }
  expect_same_bits_with_threads(spec, BinWeights::bilinear, columns.view(),
                                {columns.view().subset(0, 70'001), columns.view().subset(70'001, 29'999)});
}

// A lone return and then a long run in its bin, the rest of its word elsewhere; then words that lack but
// their first return. Whichever tiles belong to one part, each bin sees its returns once and in order.
TEST(BinKernel, RunsOfWordsKeepTheirOrder) {
  const GridSpec spec{1, 0, 0, 1, 400};
  const ThreadLimit limit(2);
  for (double other = 40; other < 400; other += 32) {
    ReturnColumns columns;
    const auto add = [&](double x) {
      columns.push_back({x, 0, 1 + 0.1 * static_cast<double>(columns.t.size()), 0, 0, 0, 0});
    };
    add(3);
    for (int i = 1; i < 64; ++i) add(other);
    for (int i = 0; i < 6 * 64; ++i) add(3);
    for (int i = 0; i < 6 * 64; ++i) add(i % 64 == 0 ? other : 3);
    for (int i = 0; i < 5 * 64; ++i) add(other);
    const Expected expected = one_by_one(columns.view(), spec, BinWeights::bilinear);
    WeightedMeanAccumulator bins(spec);
    bins.add(columns.view());
    expect_same_bits(bins.bins(), expected.bins);
  }
}

// More scattered returns in each part than are gathered at a time.
TEST(BinKernel, ScatteredReturnsHaveTheSameBitsWithThreads) {
  const GridSpec spec = GridSpec::centered(8, 0.1);
  const ReturnColumns columns = points_around(spec, 4000);
  expect_same_bits_with_threads(spec, BinWeights::equal, columns.view(), {columns.view()});
}

// Every bit by the tile of GridSpec::bin_of, several words and the last of them not whole; what lies in no
// bin is somewhere, once.
TEST(BinKernel, PartsAreThoseOfTiles) {
  const GridSpec spec{0.1, -50, -70, 300, 170};
  ReturnColumns columns = points_around(spec, 3001);
  columns.x_est[17] = kNan;
  columns.y_est[18] = kInfinity;
  columns.y_est[3000] = kNan;
  const Tiling tiling{.tile_bits = 5, .part_bits = 2};
  on_every_target([&] {
    constexpr std::size_t kStride = 47;  // words of 64 points
    std::vector<std::uint64_t> bits(4 * kStride, 0x5555);
    find_parts(spec, tiling, columns.x_est, columns.y_est, kStride, bits.data());
    std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> part_of_tile;
    for (std::size_t i = 0; i < kStride * 64; ++i) {
      std::vector<std::size_t> parts;
      for (std::size_t part = 0; part < 4; ++part)
        if ((bits[part * kStride + i / 64] >> (i % 64) & 1U) != 0) parts.push_back(part);
      ASSERT_EQ(parts.size(), i < columns.x_est.size() ? 1U : 0U) << i;
      if (parts.empty()) continue;
      const BinIndex bin = spec.bin_of(columns.x_est[i], columns.y_est[i]);
      if (!spec.contains(bin)) continue;
      const auto known = part_of_tile.try_emplace({bin.row / 32, bin.col / 32}, parts[0]).first;
      ASSERT_EQ(parts[0], known->second) << i;
    }
    EXPECT_EQ(part_of_tile.size(), 30U);  // those within reach of the points
  });
}

}  // namespace
}  // namespace landfall
