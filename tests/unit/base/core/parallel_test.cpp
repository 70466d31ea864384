// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace landfall {
namespace {

TEST(ParallelFor, VisitsEachItemOnce) {
  std::vector<int> visits(1001, 0);
  parallel_for(visits.size(), 10, [&](std::size_t begin, std::size_t end) {
    EXPECT_LE(end - begin, 10U);
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  EXPECT_EQ(visits, std::vector<int>(1001, 1));
}

TEST(ParallelFor, ProgressRisesToOne) {
  std::vector<double> fractions;
  parallel_for(
      25, 4, [](std::size_t, std::size_t) {}, [&](double f) { fractions.push_back(f); });
  ASSERT_EQ(fractions.size(), 7U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1.0);
}

TEST(ParallelFor, NoItemsIsDone) {
  double last = -1;
  parallel_for(
      0, 4, [](std::size_t, std::size_t) { FAIL(); }, [&](double f) { last = f; });
  EXPECT_EQ(last, 1.0);
}

TEST(ParallelFor, RethrowsTheWorkersError) {
  const auto fail = [](std::size_t, std::size_t) { throw std::runtime_error("worker"); };
  EXPECT_THROW(parallel_for(5, 1, fail), std::runtime_error);
}

TEST(ReadAhead, ConsumesInOrderWhatTheSlotsHold) {
  for (const std::size_t threads : {1U, 2U, 7U})
    for (const std::size_t slots : {1U, 2U, 3U}) {
      const ThreadLimit limit(threads);
      std::vector<std::size_t> slot_values(slots);
      std::vector<std::size_t> consumed;
      std::atomic<int> alive = 0;
      read_ahead(
          50, slots,
          [&](std::size_t item, std::size_t slot) {
            EXPECT_LE(static_cast<std::size_t>(++alive), slots);
            slot_values[slot] = 10 * item;
          },
          [&](std::size_t, std::size_t slot) {
            consumed.push_back(slot_values[slot]);
            --alive;
          });
      ASSERT_EQ(consumed.size(), 50U);
      for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(consumed[i], 10 * i);
    }
}

TEST(ReadAhead, RethrowsTheErrorOfEitherSide) {
  const auto nothing = [](std::size_t, std::size_t) {};
  const auto fail = [](std::size_t item, std::size_t) {
    if (item == 3) throw std::runtime_error("item 3");
  };
  EXPECT_THROW(read_ahead(5, 2, fail, nothing), std::runtime_error);
  EXPECT_THROW(read_ahead(5, 2, nothing, fail), std::runtime_error);
  EXPECT_NO_THROW(read_ahead(0, 2, fail, fail));
}

TEST(RunBoth, CallsEachOnceAlsoOnOneThread) {
  for (const std::size_t threads : {1U, 4U}) {
    const ThreadLimit limit(threads);
    std::atomic<int> first = 0;
    std::atomic<int> second = 0;
    run_both([&] { ++first; }, [&] { parallel_for(100, 7, [&](std::size_t, std::size_t) { ++second; }); });
    EXPECT_EQ(first, 1);
    EXPECT_EQ(second, 15);
  }
}

TEST(RunBoth, RethrowsTheErrorOfEither) {
  const auto nothing = [] {};
  const auto fail = [] { throw std::runtime_error("no"); };
  EXPECT_THROW(run_both(fail, nothing), std::runtime_error);
  EXPECT_THROW(run_both(nothing, fail), std::runtime_error);
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const ThreadLimit limit(1);
  EXPECT_EQ(thread_count(), 1U);
}

}  // namespace
}  // namespace landfall
