// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>

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

TEST(ThreadLimit, HoldsWhileItLives) {
  const ThreadLimit limit(1);
  EXPECT_EQ(thread_count(), 1U);
}

}  // namespace
}  // namespace landfall
