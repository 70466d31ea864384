// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/fill_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "constants.h"
#include "test_seed.h"

namespace landfall {
namespace {

/// Relief from 0 to 10 m in 201 steps.
std::vector<double> relief() {
  std::vector<double> values;
  for (int i = 0; i <= 2000; ++i) values.push_back(static_cast<double>(i * 7919 % 201) / 20);
  return values;
}

std::vector<double> fills_of(std::vector<double> values, const FillSearch::Stored& stored = {}) {
  FillSearch search(stored);
  search.add(values);
  std::vector<double> fills;
  for (const Fill& fill : search.result().fills) fills.push_back(fill.raw);
  std::ranges::sort(fills);
  return fills;
}

std::vector<double> with(std::vector<double> values, double value, int count = 2) {
  values.insert(values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                static_cast<std::size_t>(count), value);
  return values;
}

using Numbers = std::vector<double>;

TEST(FillSearch, FindsARepeatedValueFartherFromTheRestThanItsRange) {
  for (const double value : {-10000.0, -99999.9, 1e10, -88888.0, -9998.0, 8888.0, -12345.0, -10.01, 20.01})
    EXPECT_EQ(fills_of(with(relief(), value)), Numbers{value});
  EXPECT_EQ(fills_of(relief()), Numbers{});
  EXPECT_EQ(fills_of(with(relief(), -10)), Numbers{}) << "at the distance of the range";
  EXPECT_EQ(fills_of(with(relief(), -88888, 1)), Numbers{}) << "a lonely value may be a peak";
}

TEST(FillSearch, NeedsSixteenOtherValues) {
  for (const int distinct : {15, 16}) {
    Numbers values;
    for (int i = 0; i < 100; ++i) values.push_back(i % distinct);
    EXPECT_EQ(fills_of(with(values, 100)), distinct == 16 ? Numbers{100} : Numbers{});
  }
}

TEST(FillSearch, FindsSeveralFills) {
  EXPECT_EQ(fills_of(with(with(relief(), -12345), -12346)), (Numbers{-12346, -12345}));
  EXPECT_EQ(fills_of(with(with(relief(), -12345), 12345)), (Numbers{-12345, 12345}));
  EXPECT_EQ(fills_of(with(with(relief(), -12345), -9999)), (Numbers{-12345, -9999}));
  EXPECT_EQ(fills_of(with(with(relief(), -12345), 50000, 1)), Numbers{-12345}) << "with a peak";
  EXPECT_EQ(fills_of(with(with(relief(), -12345), -50000, 1)), Numbers{-12345});
}

TEST(FillSearch, FindsKnownNumbersThatAreIsolated) {
  for (const int count : {1, 2}) EXPECT_EQ(fills_of(with(relief(), -9999, count)), Numbers{-9999});
  EXPECT_EQ(fills_of(with(with(relief(), -9999), -32768)), (Numbers{-32768, -9999}));
  EXPECT_EQ(fills_of(with(with(relief(), -9999), 9999)), (Numbers{-9999, 9999}));
  EXPECT_EQ(fills_of(with(relief(), -3.4e38, 1)), Numbers{-3.4e38});
  EXPECT_EQ(fills_of({-9999, -9999}), Numbers{-9999}) << "nothing else";
  Numbers deep;
  for (int i = 0; i < 3000; ++i) deep.push_back(-9990 - i % 50);
  EXPECT_EQ(fills_of(deep), Numbers{}) << "an elevation among others";
}

TEST(FillSearch, TakesALakeForTerrain) {
  Numbers valley;
  for (int i = 0; i < 5000; ++i) valley.push_back(i % 2 == 0 ? 212 : 213 + i % 40);
  EXPECT_EQ(fills_of(valley), Numbers{});
}

TEST(FillSearch, NamesTheNumberThatTheFileStores) {
  Numbers values = relief();
  for (double& value : values) value = 0.1 * std::round(value * 20) + 3;
  const FillSearch::Stored stored{.scale = 0.1, .offset = 3, .is_integer = true};
  EXPECT_EQ(fills_of(with(values, 0.1 * -3333 + 3), stored), Numbers{-3333});
  EXPECT_EQ(fills_of(with(values, 0.1 * -9999 + 3, 1), stored), Numbers{-9999});
}

TEST(FillSearch, CountsExactlyInAnyOrder) {
  std::mt19937_64 random(test_seed());
  Numbers values = with(with(relief(), -777, 13), 5000, 40);
  values.insert(values.end(), 9, kNan);
  for (int order = 0; order < 12; ++order) {
    if (order == 0) std::ranges::sort(values);
    if (order == 1) std::ranges::reverse(values);
    if (order > 1) std::ranges::shuffle(values, random);
    FillSearch search;
    search.add(values);
    const FillSearch::Result found = search.result();
    EXPECT_EQ(found.total, 2001 + 53);
    EXPECT_EQ(found.rest.low, 0);
    EXPECT_EQ(found.rest.high, 10);
    std::map<double, std::int64_t> counts;
    for (const Fill& fill : found.fills) counts[fill.value] = fill.count;
    EXPECT_EQ(counts, (std::map<double, std::int64_t>{{-777, 13}, {5000, 40}}));
  }
}

}  // namespace
}  // namespace landfall
