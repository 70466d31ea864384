// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "app/report/evaluation_layers.h"
#include "app/report/quantised.h"
#include "app/report/report_layer.h"
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
  EXPECT_THAT(reduce(grid, 2, Rule::smallest).cells, ElementsAre(-4, 5));
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

double value_of(const Quantised& q, std::size_t i) { return q.offset + q.codes[i] * q.step; }

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(count)));
  }
  return bytes;
}

/// Decodes as the browser does, by zlib.
std::vector<std::uint16_t> unpacked(const std::string& text, std::size_t count) {
  const std::vector<std::uint8_t> packed = bytes_of_base64(text);
  std::vector<std::uint8_t> bytes(2 * count);
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(size, bytes.size());
  std::vector<std::uint16_t> codes(count);
  int before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int folded = bytes[i] + 256 * bytes[count + i];
    before = (before + (folded % 2 == 0 ? folded / 2 : -(folded + 1) / 2) + 65536) % 65536;
    codes[i] = static_cast<std::uint16_t>(before);
  }
  return codes;
}

TEST(Quantise, KeepsValuesWithinHalfARoundStep) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-7.3, 4.1);
  std::vector<double> values(5000);
  for (double& value : values) value = uniform(generator);
  for (const int steps : {10, 1000, kMaxSteps}) {
    const Quantised q = quantise(values, steps);
    EXPECT_LE((q.high - q.low) / q.step, steps);
    EXPECT_GT((q.high - q.low) / q.step, steps / 2.6);
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_NEAR(value_of(q, i), values[i], q.step * (0.5 + 1e-9)) << i;
  }
  EXPECT_DOUBLE_EQ(quantise(values, 1000).step, 0.02);
}

TEST(Quantise, KeepsMultiplesOfTheStep) {
  const std::array<double, 4> values = {-0.15, 0, 0.07, 0.13};
  const Quantised q = quantise(values, 1000);
  EXPECT_DOUBLE_EQ(q.step, 0.0005);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(value_of(q, i), values[i], 1e-15);
}

TEST(Quantise, HasACodeForNoValue) {
  const std::array<double, 4> values = {kNan, 1, kInfinity, 2};
  const Quantised q = quantise(values, 100);
  EXPECT_EQ(q.codes[0], kNoValueCode);
  EXPECT_EQ(q.codes[2], kNoValueCode);
  EXPECT_EQ(q.low, 1);
  EXPECT_EQ(q.high, 2);
  const Quantised none = quantise(std::array<double, 1>{kNan}, 100);
  EXPECT_EQ(none.codes[0], kNoValueCode);
  EXPECT_EQ(none.step, 0);
}

TEST(Quantise, KeepsASingleValueExactly) {
  const Quantised q = quantise(std::array<double, 2>{0.1234567, 0.1234567}, 100);
  EXPECT_EQ(value_of(q, 1), 0.1234567);
}

TEST(Quantise, StandsExtremeNumbers) {
  const double maximum = std::numeric_limits<double>::max();
  const Quantised wide = quantise(std::array<double, 3>{-maximum, 0, maximum}, 1000);
  EXPECT_TRUE(std::isfinite(wide.step));
  EXPECT_NEAR(value_of(wide, 1) / maximum, 0, 0.002);
  const Quantised narrow = quantise(std::array<double, 2>{0, 5e-324}, 1000);
  EXPECT_EQ(narrow.step, 0);
  // Steps below the resolution of the numbers themselves.
  const Quantised far = quantise(std::array<double, 2>{1e15, 1e15 + 0.25}, 1000);
  EXPECT_NEAR(value_of(far, 1), 1e15 + 0.25, 0.25);
}

TEST(Packed, ComesBackFromZlib) {
  std::vector<std::uint16_t> codes = {0, 65535, 0, 1, 32768, 65535, 65535, 32767, 100};
  std::mt19937 generator(5);
  for (int i = 0; i < 3000; ++i) codes.push_back(static_cast<std::uint16_t>(generator()));
  EXPECT_EQ(unpacked(packed(codes), codes.size()), codes);
  EXPECT_EQ(unpacked(packed(std::vector<std::uint16_t>(1000, 7)), 1000), std::vector<std::uint16_t>(1000, 7));
}

}  // namespace
}  // namespace landfall::html_report
