// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/draw_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/core/parallel.h"

namespace landfall {
namespace {

TEST(DrawLanes, HalfOfTheMemory) {
  EXPECT_EQ(draw_lanes(16, 10, 1000), (DrawLanes{16, 1}));
  EXPECT_EQ(draw_lanes(16, 10, 150), (DrawLanes{8, 2}));  // half of 150 and of the 10 that the first one has
  EXPECT_EQ(draw_lanes(16, 10, 90), (DrawLanes{5, 4}));
  EXPECT_EQ(draw_lanes(16, 10, 9), (DrawLanes{1, 16}));
  EXPECT_EQ(draw_lanes(16, 10, 0), (DrawLanes{1, 16}));
  EXPECT_EQ(draw_lanes(3, 0, 0), (DrawLanes{3, 1}));
  EXPECT_EQ(draw_lanes(3, 10, std::nullopt), (DrawLanes{3, 1}));
}

/// Draws whose result is 3 i, made by a parallel sum; the work on them is watched.
class MakeDraws : public ::testing::TestWithParam<DrawLanes> {
 protected:
  DrawWork work() {
    return {[this] { return begun_++ < may_begin_; },
            [this](std::int64_t draw, std::size_t lane) { make(draw, lane); },
            [this](std::int64_t draw, std::size_t lane) {
              EXPECT_EQ(draw, std::ssize(added_));
              if (draw == refused_) throw std::runtime_error("add " + std::to_string(draw));
              added_.push_back(results_.at(lane));
              return draw != last_;
            }};
  }

  void make(std::int64_t draw, std::size_t lane) {
    EXPECT_LE(thread_count(), lanes_.threads);
    if (std::ranges::find(failing_, draw) != failing_.end())
      throw std::runtime_error("make " + std::to_string(draw));
    EXPECT_EQ(users_.at(lane)++, 0);
    std::atomic<std::int64_t> sum = 0;
    parallel_for(300, 1, [&](std::size_t, std::size_t) { sum += draw; });
    results_.at(lane) = sum / 100;
    --users_.at(lane);
  }

  static std::vector<std::int64_t> expected(std::int64_t count) {
    std::vector<std::int64_t> values;
    for (std::int64_t draw = 0; draw < count; ++draw) values.push_back(3 * draw);
    return values;
  }

  ThreadLimit limit_{4};
  DrawLanes lanes_ = GetParam();
  std::vector<std::int64_t> results_ = std::vector<std::int64_t>(lanes_.draws);
  std::vector<std::atomic<int>> users_ = std::vector<std::atomic<int>>(lanes_.draws);
  std::vector<std::int64_t> added_, failing_;
  std::atomic<std::int64_t> begun_ = 0;
  std::int64_t may_begin_ = 1000, refused_ = -1, last_ = -1;
};

TEST_P(MakeDraws, AddsAllInOrder) {
  EXPECT_TRUE(make_draws(100, lanes_, work()));
  EXPECT_EQ(added_, expected(100));
  EXPECT_TRUE(make_draws(0, lanes_, work()));
}

TEST_P(MakeDraws, EndsWithTheDrawThatDecides) {
  last_ = 20;
  failing_ = {21, 22, 23, 24, 25, 26, 27, 28};  // made before it was known, perhaps
  EXPECT_FALSE(make_draws(100, lanes_, work()));
  EXPECT_EQ(added_, expected(21));
}

TEST_P(MakeDraws, AddsWhatHasBegun) {
  may_begin_ = 30;
  EXPECT_FALSE(make_draws(100, lanes_, work()));
  EXPECT_LE(std::ssize(added_), 30);
  EXPECT_GT(std::ssize(added_), 30 - std::ssize(results_));
  EXPECT_EQ(added_, expected(std::ssize(added_)));
}

TEST_P(MakeDraws, RethrowsTheFirstErrorInOrder) {
  failing_ = {40, 41, 42, 43, 44, 45, 46};
  try {
    make_draws(100, lanes_, work());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "make 40");
  }
  EXPECT_EQ(added_, expected(40));
}

TEST_P(MakeDraws, RethrowsAnErrorOfAdding) {
  refused_ = 7;
  EXPECT_THROW(make_draws(100, lanes_, work()), std::runtime_error);
  EXPECT_EQ(added_, expected(7));
}

INSTANTIATE_TEST_SUITE_P(Lanes, MakeDraws,
                         ::testing::Values(DrawLanes{1, 4}, DrawLanes{2, 2}, DrawLanes{3, 2},
                                           DrawLanes{4, 1}));

}  // namespace
}  // namespace landfall
