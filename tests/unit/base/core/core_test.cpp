// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "base/core/fields.h"
#include "base/core/hash.h"
#include "base/core/parallel.h"

namespace landfall {
namespace {

using testing::ElementsAre;

struct Point {
  double x = 0;
  double y = 0;
  LANDFALL_FIELDS(x, y)
};

struct Shown {
  static constexpr bool kShownEmpty = true;
  int size = 7;
  Point centre;
  LANDFALL_FIELDS(size, centre)
};

struct Shape {
  std::optional<Point> corner;
  std::optional<Shown> inner;
  int last = 1;
  static void fields(auto& walk, auto& m) {
    walk.inside("outer", [&] { walk.all("corner, inner", m.corner, m.inner); });
    walk("last", m.last);
  }
};

/// "path=value" of each visited value.
struct List {
  std::vector<std::string>& lines;
  void operator()(const std::string& path, std::nullopt_t /*none*/) const { lines.push_back(path + "=none"); }
  void operator()(const std::string& path, const auto& value) const {
    lines.push_back(path + "=" + std::to_string(static_cast<int>(value)));
  }
};

std::vector<std::string> listed(const Shape& shape) {
  std::vector<std::string> lines;
  FieldWalk walk{List{lines}};
  Shape::fields(walk, shape);
  return lines;
}

TEST(FieldWalk, VisitsNestedValuesInTheirOrder) {
  EXPECT_THAT(listed({.corner = Point{1, 2}, .inner = Shown{3, {4, 5}}}),
              ElementsAre("outer.corner.x=1", "outer.corner.y=2", "outer.inner.size=3",
                          "outer.inner.centre.x=4", "outer.inner.centre.y=5", "last=1"));
}

TEST(FieldWalk, LeavesOutOrShowsWhatIsEmpty) {
  EXPECT_THAT(listed({}), ElementsAre("outer.inner.size=none", "outer.inner.centre.x=none",
                                      "outer.inner.centre.y=none", "last=1"));
}

/// Counts up, in all but the structs of one name.
struct Fill {
  int& next;
  std::string absent;
  [[nodiscard]] bool has(const std::string& path) const { return path != absent; }
  void operator()(const std::string& /*path*/, auto& value) const { value = ++next; }
};

TEST(FieldWalk, FillsOptionalStructsThatHaveValues) {
  for (const char* const absent : {"outer.corner", "outer.inner", ""}) {
    Shape shape;
    int next = 0;
    FieldWalk walk{Fill{next, absent}};
    Shape::fields(walk, shape);
    EXPECT_EQ(shape.corner.has_value(), std::string(absent) != "outer.corner");
    EXPECT_EQ(shape.inner.has_value(), std::string(absent) != "outer.inner");
    EXPECT_EQ(shape.last, next);
    EXPECT_EQ(next, *absent == '\0' ? 6 : shape.corner ? 3 : 4);
  }
}

// XXH3 128-bit of no input, from the xxHash specification.
TEST(Hash, EmptyInput) { EXPECT_EQ(Hash().hex(), "99aa06d3014798d86001c324468d497f"); }

TEST(Hash, WordsAreTheDigitsOfHex) {
  EXPECT_EQ(Hash().words(), (std::array<std::uint64_t, 2>{0x99aa06d3014798d8, 0x6001c324468d497f}));
}

TEST(Hash, PieceBoundariesOfTextCount) {
  Hash a;
  Hash b;
  a.update("ab").update("c");
  b.update("a").update("bc");
  EXPECT_NE(a.hex(), b.hex());
}

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

TEST(ThreadSupply, CountsThisThread) {
  EXPECT_EQ(thread_supply(1), 1U);
  EXPECT_EQ(thread_supply(0), 1U);
}

TEST(ThreadSupply, GivesWhatIsWantedWhereNothingForbidsIt) { EXPECT_EQ(thread_supply(4), 4U); }

}  // namespace
}  // namespace landfall
