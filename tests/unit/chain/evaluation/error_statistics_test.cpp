// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "bins.h"
#include "chain/evaluation/error_statistics.h"
#include "chain/evaluation/piecewise.h"
#include "chain/evaluation/quantile/error_tails.h"
#include "chain/evaluation/quantile/tail_cursor.h"
#include "constants.h"

namespace landfall {
namespace {

// In the region 1 2 3 6 and a NaN: mean 3, deviations -2 -1 0 3, median 2.5, |e - median| 0.5 0.5 1.5 3.5.
TEST(ErrorStatistics, ByHand) {
  const Grid<double> error = row_with({100, 1, kNan, 6, 2, 3, -100});
  BinMask region(error.spec(), 1);
  region.values().front() = region.values().back() = 0;
  const ErrorStatistics statistics = error_statistics(error, region);
  EXPECT_EQ(statistics.count, 4);
  EXPECT_EQ(statistics.mean_m, 3);
  EXPECT_DOUBLE_EQ(statistics.std_m.value(), std::sqrt(14.0 / 4));
  EXPECT_DOUBLE_EQ(statistics.rmse_m.value(), std::sqrt(50.0 / 4));
  EXPECT_EQ(statistics.median_m, 2.5);
  EXPECT_DOUBLE_EQ(statistics.nmad_m.value(), 1.4826 * 1);
  EXPECT_NEAR(statistics.le90_m.value(), 3 + 0.7 * 3, 1e-14);  // h = 2.7
  EXPECT_NEAR(statistics.p95_m.value(), 3 + 0.85 * 3, 1e-14);  // h = 2.85
}

TEST(ErrorStatistics, QuantilesOfMagnitudesAreNotThoseOfErrors) {
  const ErrorStatistics statistics =
      error_statistics(row_with({-10, 0, 1}), BinMask(GridSpec{1, 0, 0, 1, 3}, 1));
  EXPECT_EQ(statistics.median_m, 0);
  EXPECT_NEAR(statistics.le90_m.value(), 1 + 0.8 * 9, 1e-14);
}

TEST(ErrorStatistics, WithoutAnErrorOnlyTheCount) {
  const Grid<double> error = row_with({kNan, 5});
  BinMask region(error.spec());
  region.at({0, 0}) = 1;
  EXPECT_EQ(error_statistics(error, region), ErrorStatistics{.count = 0});
  EXPECT_EQ(horizontal_statistics(error, region), HorizontalStatistics{.count = 0});
}

// A normal distribution: NMAD and standard deviation agree, LE90 is 1.645 sigma, CE90 of two such errors
// 2.146 sigma. Bounds: five standard errors of each estimate at 360,000 values.
TEST(ErrorStatistics, NormalErrors) {
  const GridSpec spec{1, 0, 0, 600, 600};
  const RandomField noise(11, RandomStream::range_noise);
  Grid<double> error(spec);
  Grid<double> horizontal(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    error.values()[i] = 0.02 + 0.5 * noise.normal(i, 0);
    horizontal.values()[i] = std::hypot(0.5 * noise.normal(i, 1), 0.5 * noise.normal(i, 2));
  }
  const BinMask everywhere(spec, 1);
  const ErrorStatistics statistics = error_statistics(error, everywhere);
  EXPECT_NEAR(statistics.mean_m.value(), 0.02, 0.0042);
  EXPECT_NEAR(statistics.std_m.value(), 0.5, 0.003);
  EXPECT_NEAR(statistics.nmad_m.value(), 0.5, 0.005);
  EXPECT_NEAR(statistics.le90_m.value(), 1.645 * 0.5, 0.013);
  EXPECT_NEAR(horizontal_statistics(horizontal, everywhere).ce90_m.value(), 2.146 * 0.5, 0.013);
  EXPECT_NEAR(horizontal_statistics(horizontal, everywhere).rmse_m.value(), std::sqrt(0.5), 0.004);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(error_statistics(error, everywhere), statistics);
  }
}

// Squares of the errors themselves would lose what is left beside them.
TEST(ErrorStatistics, DeviationsBesideALargeMean) {
  const ErrorStatistics statistics =
      error_statistics(row_with({1e9 - 1, 1e9, 1e9 + 1}), BinMask(GridSpec{1, 0, 0, 1, 3}, 1));
  EXPECT_EQ(statistics.mean_m, 1e9);
  EXPECT_DOUBLE_EQ(statistics.std_m.value(), std::sqrt(2.0 / 3));
}

// Values are taken in pieces; the last one is full, holds one value, or holds but one that counts.
TEST(ErrorStatistics, WholePiecesAndOneMore) {
  for (const std::size_t more : {0U, 1U}) {
    const GridSpec spec{1, 0, 0, 1, static_cast<std::int64_t>(kValuesPerPiece + more)};
    Grid<double> error(spec, kNan);
    error.values().front() = 1;
    error.values()[kValuesPerPiece - 1] = -2;
    error.values().back() = -5;
    const ErrorStatistics statistics = error_statistics(error, BinMask(spec, 1));
    EXPECT_EQ(statistics.count, 2 + more);
    EXPECT_EQ(statistics.median_m, -2.0);
    EXPECT_EQ(statistics.mean_m, -2.0);
    EXPECT_DOUBLE_EQ(statistics.nmad_m.value(), 1.4826 * 3);
    EXPECT_NEAR(statistics.le90_m.value(), more == 0 ? 4.6 : 4.4, 1e-14);
    EXPECT_EQ(horizontal_statistics(error, BinMask(spec, 1)).count, 2 + more);
  }
}

// The sorted tails of a tile's windows, and who is a member of which, against the definition of a footprint.
constexpr std::size_t kPad = ErrorTail::kPad;

void expect_tile(const Tile& tile, const Tile& expected) {
  EXPECT_EQ(tile.first_row, expected.first_row);
  EXPECT_EQ(tile.first_col, expected.first_col);
  EXPECT_EQ(tile.rows, expected.rows);
  EXPECT_EQ(tile.cols, expected.cols);
}

TEST(Reach, ClippedAtTheGridsBorders) {
  const GridSpec spec{1, 0, 0, 10, 12};
  const Tile tile{2, 3, 4, 5};
  expect_tile(reach(spec, tile, 0), tile);
  expect_tile(reach(spec, tile, 1), {1, 2, 6, 7});
  expect_tile(reach(spec, tile, 2), {0, 1, 8, 9});
  expect_tile(reach(spec, tile, 4), {0, 0, 10, 12});
  expect_tile(reach(spec, tile, 50), {0, 0, 10, 12});
}

TEST(CollectTails, KeepsWhatIsOutsideTheOpenInterval) {
  const Grid<double> error = grid_with({1, 0, 0, 3, 4}, {9, 9, 9, 9,     //
                                                         9, 2, 1.9, -9,  //
                                                         9, -1, kNan, -9});
  ErrorTails tails;
  collect_tails(error, {1, 1, 2, 2}, {.upper = 2, .lower = -1}, tails);
  ASSERT_EQ(tails.upper.size(), 1U);
  EXPECT_EQ(tails.upper.bins[0].value, 2);
  EXPECT_EQ(tails.upper.bins[0].row, 1);
  EXPECT_EQ(tails.upper.bins[0].col, 1);
  ASSERT_EQ(tails.lower.size(), 1U);
  EXPECT_EQ(tails.lower.bins[0].value, 1);
  EXPECT_EQ(tails.lower.bins[0].row, 2);
  EXPECT_EQ(tails.lower.bins[0].col, 1);
  // Bounds that have crossed: a bin between them is in both.
  collect_tails(error, {1, 1, 2, 2}, {.upper = -1, .lower = 1.9}, tails);
  EXPECT_EQ(tails.upper.size(), 3U);
  EXPECT_EQ(tails.lower.size(), 2U);
}

TEST(CountBits, AsOneByOne) {
  const RandomField draw(8, RandomStream::dropout);
  for (std::uint64_t i = 0; i < 200; ++i) {
    std::uint64_t set = i == 0 ? 0 : i == 1 ? ~std::uint64_t{0} : 0;
    for (unsigned bit = 0; i > 1 && bit < 64; ++bit)
      set |= std::uint64_t{draw.uniform(i, bit) < static_cast<double>(i) / 200 ? 1U : 0U} << bit;
    std::size_t count = 0;
    for (unsigned bit = 0; bit < 64; ++bit) count += (set >> bit) & 1U;
    EXPECT_EQ(count_bits(set), count) << set;
  }
  for (unsigned bit = 0; bit < 64; ++bit) EXPECT_EQ(count_bits(std::uint64_t{1} << bit), 1U);
}

/// Whether the footprint about the tile's window holds the bin.
bool holds(const Footprint& footprint, const Tile& tile, BinIndex window, const TailBin& bin) {
  const std::int64_t up = bin.row - tile.first_row - window.row;
  const std::int64_t across = bin.col - tile.first_col - window.col;
  return std::abs(up) <= footprint.half_bins() && std::abs(across) <= footprint.half_width(up);
}

/// By place, the padding with it.
std::vector<bool> members_by_definition(const ErrorTail& tail, const Footprint& footprint, const Tile& tile,
                                        BinIndex window) {
  std::vector<bool> members(tail.size() + 2 * kPad, false);
  members[kPad - 1] = members[kPad + tail.size()] = true;
  for (std::size_t i = 0; i < tail.size(); ++i)
    members[kPad + i] = holds(footprint, tile, window, tail.bins[i]);
  return members;
}

std::size_t count(const std::vector<bool>& members, std::size_t begin, std::size_t end) {
  return static_cast<std::size_t>(std::count(members.begin() + static_cast<std::ptrdiff_t>(begin),
                                             members.begin() + static_cast<std::ptrdiff_t>(end), true));
}

void expect_members(const TailMembers& found, const std::vector<bool>& members) {
  const std::size_t last = members.size() - kPad;  // the place behind the bins
  for (std::size_t place = kPad; place <= last; ++place) {
    EXPECT_EQ(found.count_before(place), count(members, 0, place)) << place;
    std::size_t next = place;
    while (!members[next]) ++next;
    std::size_t previous = place - 1;
    while (!members[previous]) --previous;
    EXPECT_EQ(found.next(place), next) << place;
    EXPECT_EQ(found.previous(place), previous) << place;
    const std::size_t word_end = std::min(place / 64 * 64 + 64, members.size());
    if (!members[place]) continue;
    const TailMembers::Run rest = found.rest_of_word(place);
    EXPECT_EQ(rest.first, place);
    EXPECT_EQ(rest.count, count(members, place, word_end));
    EXPECT_EQ(count(members, rest.last, word_end), 1U);
    const TailMembers::Run start = found.start_of_word(place);
    EXPECT_EQ(start.last, place);
    EXPECT_EQ(start.count, count(members, place / 64 * 64, place + 1));
    EXPECT_EQ(count(members, place / 64 * 64, start.first + 1), 1U);
    EXPECT_TRUE(members[rest.last] && members[start.first]);
  }
}

/// A tail of noise over all bins that the tile's windows reach.
ErrorTail noise_tail(const GridSpec& spec, const Tile& tile, std::int64_t half_bins) {
  const RandomField draw(5, RandomStream::range_noise);
  const Tile reached = reach(spec, tile, half_bins);
  ErrorTail tail;
  for (const auto [row, col] : Bins({reached.first_row, reached.first_col},
                                    {reached.first_row + reached.rows, reached.first_col + reached.cols}))
    tail.bins.push_back({draw.normal(static_cast<std::uint64_t>(row), static_cast<std::uint64_t>(col)),
                         static_cast<std::int32_t>(row), static_cast<std::int32_t>(col)});
  return tail;
}

TEST(ErrorTail, MembersAreTheFootprintsBins) {
  const GridSpec spec{1, 0, 0, 18, 21};
  ErrorTail tail;  // nothing of one footprint shows in the next
  for (const Footprint& footprint :
       {Footprint::square(0), Footprint::square(3), Footprint::disc(10), Footprint::disc(1)})
    for (const Tile& tile : {Tile{0, 0, 4, 5}, Tile{7, 9, 3, 2}, Tile{13, 15, 5, 6}}) {
      tail.bins = noise_tail(spec, tile, footprint.half_bins()).bins;
      tail.build(tile, footprint);
      for (std::int64_t row = 0; row < tile.rows; ++row) {
        tail.enter_row(row);
        for (std::int64_t col = 0; col < tile.cols; ++col)
          expect_members(TailMembers(tail, col), members_by_definition(tail, footprint, tile, {row, col}));
      }
    }
}

// More words of places than a few, the last one as full as can be.
TEST(ErrorTail, MembersOfALongTail) {
  const GridSpec spec{1, 0, 0, 40, 40};
  const Tile tile{18, 18, 3, 3};
  for (const std::size_t size : {1120U, 1137U, 1183U, 1184U}) {
    const Footprint footprint = Footprint::square(17);
    ErrorTail tail = noise_tail(spec, tile, 17);
    tail.bins.resize(size);
    tail.build(tile, footprint);
    tail.enter_row(1);
    for (std::int64_t col = 0; col < 3; ++col) {
      const std::vector<bool> members = members_by_definition(tail, footprint, tile, {1, col});
      const TailMembers found(tail, col);
      for (const std::size_t place : {kPad, std::size_t{700}, kPad + size})
        EXPECT_EQ(found.count_before(place), count(members, 0, place)) << size << ' ' << col;
      EXPECT_EQ(found.next(kPad + size), kPad + size);
      EXPECT_GT(64 * tail.words(), kPad + size);
    }
  }
}

TEST(ErrorTail, ValuesDescendBetweenTheirPadding) {
  const Tile tile{2, 2, 3, 3};
  const Footprint footprint = Footprint::square(2);
  ErrorTail tail = noise_tail({1, 0, 0, 9, 9}, tile, 2);
  tail.build(tile, footprint);
  ASSERT_EQ(tail.size(), 49U);
  for (std::size_t i = 0; i < kPad; ++i) {
    EXPECT_EQ(tail.values()[i], kInfinity);
    EXPECT_EQ(tail.values()[kPad + 49 + i], -kInfinity);
  }
  for (std::size_t i = 0; i < 49; ++i) {
    EXPECT_EQ(tail.values()[kPad + i], tail.bins[i].value);
    EXPECT_TRUE(i == 0 || tail.bins[i - 1].value >= tail.bins[i].value);
  }
}

/// 200 bins of 100, 99, .. -99, all in the one window; they stand at the places kPad, kPad + 1, .. and the
/// first word of places holds 48 of them, the next two 64 each.
class TailCursorMoves : public testing::Test {
 protected:
  TailCursorMoves() {
    for (std::int32_t i = 0; i < 200; ++i) tail_.bins.push_back({100.0 - i, i / 15, i % 15});
    tail_.build({7, 7, 1, 1}, footprint_);
    tail_.enter_row(0);
  }
  [[nodiscard]] TailCursor at(std::size_t place) const { return {tail_, {.col = 0, .centre = 10}, place}; }

  Footprint footprint_ = Footprint::square(7);
  ErrorTail tail_;
};

TEST_F(TailCursorMoves, DeviationsOnEitherSide) {
  EXPECT_EQ(at(kPad).count_taken(), 1U);  // the padding
  EXPECT_EQ(at(kPad).next_deviation(), 90);
  EXPECT_EQ(at(kPad).previous_deviation(), kInfinity);
  EXPECT_EQ(at(kPad + 130).count_taken(), 131U);
  EXPECT_EQ(at(kPad + 130).next_deviation(), -40);
  EXPECT_EQ(at(kPad + 130).previous_deviation(), -39);
  EXPECT_EQ(at(kPad + 200).next_deviation(), -kInfinity);
}

TEST_F(TailCursorMoves, TakesOneOrTheRestOfAWord) {
  const auto taken = [&](std::size_t place, std::size_t maximum, double minimum) {
    TailCursor cursor = at(place);
    const std::size_t before = cursor.count_taken();
    const std::size_t count = cursor.take(maximum, minimum);
    EXPECT_EQ(cursor.count_taken(), before + count);
    return count;
  };
  EXPECT_EQ(taken(kPad, 48, 0), 48U);
  EXPECT_EQ(taken(kPad, 47, 0), 1U);    // more than are wanted
  EXPECT_EQ(taken(kPad, 60, 43), 48U);  // the last deviates by 100 - 47 - 10
  EXPECT_EQ(taken(kPad, 60, 43.5), 1U);
  EXPECT_EQ(taken(64, 64, -100), 64U);
  EXPECT_EQ(taken(100, 28, -100), 28U);
  EXPECT_EQ(taken(kPad + 190, 60, -kInfinity), 1U);  // the padding is never taken
  EXPECT_EQ(taken(kPad, 1, -kInfinity), 1U);
}

TEST_F(TailCursorMoves, GivesBackOneOrTheStartOfAWord) {
  const auto given = [&](std::size_t place, std::size_t maximum, double largest) {
    TailCursor cursor = at(place);
    const std::size_t before = cursor.count_taken();
    const std::size_t count = cursor.give_back(maximum, largest);
    EXPECT_EQ(cursor.count_taken(), before - count);
    return count;
  };
  EXPECT_EQ(given(128, 64, kInfinity), 64U);
  EXPECT_EQ(given(128, 63, kInfinity), 1U);
  EXPECT_EQ(given(128, 64, 42), 64U);  // the first deviates by 100 - 48 - 10
  EXPECT_EQ(given(128, 64, 41.5), 1U);
  EXPECT_EQ(given(80, 16, kInfinity), 16U);
  EXPECT_EQ(given(40, 60, kInfinity), 1U);  // the padding is never given back
  EXPECT_EQ(given(128, 1, kInfinity), 1U);
}

}  // namespace
}  // namespace landfall
