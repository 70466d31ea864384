// SPDX-License-Identifier: GPL-3.0-or-later
// Every method against a slow, obvious one, and against itself at other thread counts and batch sizes.
#include "chain/gridding/method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tuple>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "bins.h"
#include "chain/gridding/accumulators.h"
#include "map_layers.h"
#include "random_returns.h"
#include "refusal.h"
#include "return_columns.h"

namespace landfall {
namespace {

constexpr Method kMethods[] = {
    Method::bilinear_nearest, Method::bilinear4, Method::mean, Method::min, Method::max, Method::median};

/// The returns whose values stand for the bin, with their weights.
std::vector<Member> chosen(Method method, std::vector<Member> in) {
  if (method != Method::min && method != Method::max && method != Method::median) return in;
  std::ranges::stable_sort(in, {}, [](const Member& m) { return m.point.z_est; });
  if (method == Method::min) return {in.front()};
  if (method == Method::max)
    return {*std::ranges::find(in, in.back().point.z_est, [](const Member& m) { return m.point.z_est; })};
  return {in[(in.size() - 1) / 2], in[in.size() / 2]};
}

std::unique_ptr<Accumulator> gathered(std::unique_ptr<Accumulator> map, const GridPoints& points,
                                      std::size_t batch) {
  do {
    for (std::size_t first = 0; first < points.size(); first += batch)
      map->add(points.subset(first, std::min(batch, points.size() - first)));
  } while (map->end_pass());
  return map;
}

void expect_values(const BinValues& found, const std::vector<Member>& all, Method method) {
  const std::vector<Member> members = chosen(method, all);
  const auto expected = [&](auto value) { return mean(members, value); };
  EXPECT_EQ(found.count, static_cast<std::int32_t>(all.size()));
  EXPECT_NEAR(found.weight_sum,
              std::accumulate(all.begin(), all.end(), 0.0,
                              [](double sum, const Member& m) { return sum + m.weight; }),
              1e-11);
  EXPECT_NEAR(found.z_est, expected([](const ReturnPoint& p) { return p.z_est; }), 1e-11);
  EXPECT_NEAR(found.x_true, expected([](const ReturnPoint& p) { return p.x_true; }), 1e-11);
  EXPECT_NEAR(found.y_true, expected([](const ReturnPoint& p) { return p.y_true; }), 1e-11);
  EXPECT_NEAR(found.x_est, expected([](const ReturnPoint& p) { return p.x_est; }), 1e-11);
  EXPECT_NEAR(found.y_est, expected([](const ReturnPoint& p) { return p.y_est; }), 1e-11);
  EXPECT_NEAR(found.x_offset, found.x_true - found.x_est, 1e-11);
  EXPECT_NEAR(found.y_offset, found.y_true - found.y_est, 1e-11);
  EXPECT_NEAR(found.t, expected([](const ReturnPoint& p) { return p.t; }), 1e-11);
  const double z = mean(all, [](const ReturnPoint& p) { return p.z_est; });
  const double variance = mean(all, [=](const ReturnPoint& p) { return (p.z_est - z) * (p.z_est - z); });
  EXPECT_NEAR(found.spread, std::sqrt(variance), 1e-6);
}

class Methods : public testing::TestWithParam<Method> {};

TEST_P(Methods, AgreesWithTheSlowOne) {
  const GridSpec spec = GridSpec::centered(2, 0.25);
  const std::vector<ReturnPoint> points = random_points(spec, 400);
  const ReturnColumns columns(points);
  const auto map = gathered(make_accumulator(GetParam(), spec), columns.view(), 100);
  const Members members = members_of(GetParam(), spec, points);
  ASSERT_LT(members.size(), spec.size());  // some bins are empty
  const std::vector<BinValues> values = all_values(*map);
  for (const auto [row, col] : bins_of(spec)) {
    const auto found = members.find({row, col});
    const BinValues& value = values[spec.index({row, col})];
    if (found == members.end()) {
      EXPECT_EQ(value.count, 0);
      EXPECT_TRUE(std::isnan(value.z_est) && std::isnan(value.weight_sum) && std::isnan(value.spread));
    } else {
      expect_values(value, found->second, GetParam());
    }
  }
}

TEST_P(Methods, EveryReturnIsCountedOnceInsideOrOutside) {
  const GridSpec spec = GridSpec::centered(1, 0.5);
  std::vector<ReturnPoint> points = {
      {.x_est = 0.1},  {.x_est = 1.3}, {.x_est = 1.5}, {.y_est = -1.6}, {.x_est = -1.4, .y_est = 1.4},
      {.x_est = 1e300}};
  const ReturnColumns columns(points);
  const auto map = gathered(make_accumulator(GetParam(), spec), columns.view(), 4);
  // Four centres reach half a metre beyond the outer ones, bins a quarter.
  EXPECT_EQ(map->inside_count(), GetParam() == Method::bilinear4 ? 3 : 1);
  EXPECT_EQ(map->inside_count() + map->outside_count(), 6);
}

// Points without an estimate are skipped, wherever they stand between the returns.
TEST_P(Methods, APointThatIsNotANumberReachesNoBin) {
  const GridSpec spec = GridSpec::centered(2, 0.25);
  std::vector<ReturnPoint> points = random_points(spec, 5000);
  const ReturnColumns returns(points);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < points.size(); i += 3 + i % 5)
    points.insert(points.begin() + static_cast<std::ptrdiff_t>(i),
                  {.x_est = kNaN, .y_est = kNaN, .z_est = kNaN});
  const ReturnColumns with_gaps(points);
  for (const std::size_t threads : {1U, 2U}) {
    const ThreadLimit limit(threads);
    const auto expected = gathered(make_accumulator(GetParam(), spec), returns.view(), 5000);
    const auto found = gathered(make_accumulator(GetParam(), spec), with_gaps.view(), 999);
    EXPECT_EQ(found->inside_count(), expected->inside_count());
    const std::vector<BinValues> a = all_values(*expected);
    const std::vector<BinValues> b = all_values(*found);
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].count, b[i].count);
      ASSERT_EQ(std::memcmp(&a[i].weight_sum, &b[i].weight_sum, 10 * sizeof(double)), 0) << i;
    }
  }
}

TEST_P(Methods, SameBitsAtAnyThreadCountAndBatchSize) {
  const GridSpec spec = GridSpec::centered(10, 0.25);
  const ReturnColumns columns(random_points(spec, 150'000));
  const GridPoints points = columns.view();
  const std::vector<BinValues> reference =
      all_values(*gathered(make_accumulator(GetParam(), spec), points, points.size()));
  for (const std::size_t threads : {1U, 2U, 7U})
    for (const std::size_t batch : {std::size_t{70'001}, std::size_t{999}}) {
      const ThreadLimit limit(threads);
      const auto values = all_values(*gathered(make_accumulator(GetParam(), spec), points, batch));
      for (std::size_t i = 0; i < values.size(); ++i) {
        ASSERT_EQ(values[i].count, reference[i].count);
        ASSERT_EQ(std::memcmp(&values[i].weight_sum, &reference[i].weight_sum, 10 * sizeof(double)), 0)
            << "bin " << i << ", " << threads << " threads, batches of " << batch;
      }
    }
}

// Millimetres on top of a million metres.
TEST_P(Methods, SpreadSurvivesALargeOffset) {
  const ReturnColumns columns(
      {{.z_est = 1e6}, {.z_est = 1e6 + 0x1p-9}, {.z_est = 1e6}, {.z_est = 1e6 + 0x1p-9}});
  const auto map = gathered(make_accumulator(GetParam(), GridSpec::centered(1, 1)), columns.view(), 3);
  EXPECT_EQ(all_values(*map)[4].spread, 0x1p-10);
}

// In steps of a quarter of a bin, over the border: a return is inside where some bin sees it.
TEST_P(Methods, InsideIsWhatReachesABin) {
  const GridSpec spec = GridSpec::centered(1, 1);
  const ThreadLimit limit(1);
  for (double x = -2.5; x <= 2.5; x += 0.25)
    for (double y = -2.5; y <= 2.5; y += 0.25) {
      const std::vector<ReturnPoint> point{{.x_est = x, .y_est = y}};
      const ReturnColumns columns(point);
      const std::int64_t inside = members_of(GetParam(), spec, point).empty() ? 0 : 1;
      const auto map = gathered(make_accumulator(GetParam(), spec), columns.view(), 1);
      EXPECT_EQ(map->inside_count(), inside) << x << ' ' << y;
      EXPECT_EQ(map->outside_count(), 1 - inside) << x << ' ' << y;
    }
}

// More than one piece of work, whose bits are those of one thread.
TEST_P(Methods, SeveralPiecesOfWork) {
  const GridSpec spec = GridSpec::centered(2, 0.25);
  const ReturnColumns columns(random_points(spec, 70'000));
  const auto bits = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return all_values(*gathered(make_accumulator(GetParam(), spec), columns.view(), 70'000));
  };
  const std::vector<BinValues> one = bits(1);
  const std::vector<BinValues> two = bits(2);
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].count, two[i].count);
    ASSERT_EQ(std::memcmp(&one[i].weight_sum, &two[i].weight_sum, 10 * sizeof(double)), 0) << i;
  }
}

TEST_P(Methods, RefusesAGridWithoutBins) {
  EXPECT_THROW(static_cast<void>(make_accumulator(GetParam(), GridSpec{0.1, 0, 0, 0, 5})), UsageError);
  EXPECT_THROW(static_cast<void>(make_accumulator(GetParam(), GridSpec{0, 0, 0, 5, 5})), UsageError);
}

INSTANTIATE_TEST_SUITE_P(All, Methods, testing::ValuesIn(kMethods));

// More returns than are taken at a time: none is lost or seen twice. One column stands for all; only the last
// return lies in the map.
TEST(LargeBatches, TakeMoreReturnsThanOnePass) {
  for (const auto& [method, threads, pass] : {std::tuple{Method::bilinear_nearest, 1U, 20U},
                                              {Method::bilinear_nearest, 2U, 20U},
                                              {Method::bilinear4, 2U, 22U},
                                              {Method::min, 2U, 22U}}) {
    const ThreadLimit limit(threads);
    std::vector<double> column((std::size_t{1} << pass) + 7, 9.0);
    column.back() = 0;
    const auto map = make_accumulator(method, GridSpec::centered(1, 1));
    map->add({column, column, column, column, column, column, column});
    EXPECT_EQ(map->inside_count(), 1);
    EXPECT_EQ(map->outside_count(), std::ssize(column) - 1);
    EXPECT_EQ(all_values(*map)[4].count, 1);
  }
}

TEST(MakeAccumulator, KnowsNoOtherMethod) {
  EXPECT_THROW(static_cast<void>(make_accumulator(static_cast<Method>(99), GridSpec::centered(1, 1))),
               std::logic_error);
}

TEST(BilinearAccumulator, WeightsByHand) {
  // A quarter of the way from centre (0, 0) to (1, 0), half of the way to (0, 1).
  const ReturnColumns columns({{.x_est = 0.25, .y_est = 0.5, .z_est = 3}});
  const auto map = gathered(make_accumulator(Method::bilinear4, GridSpec::centered(1, 1)), columns.view(), 1);
  const std::vector<BinValues> v = all_values(*map);
  EXPECT_EQ(v[4].weight_sum, 0.375);
  EXPECT_EQ(v[5].weight_sum, 0.125);
  EXPECT_EQ(v[7].weight_sum, 0.375);
  EXPECT_EQ(v[8].weight_sum, 0.125);
  EXPECT_EQ(std::ranges::count(v, 1, &BinValues::count), 4);
  EXPECT_EQ(v[8].z_est, 3);
}

TEST(BilinearAccumulator, AReturnOnACentreCountsThereOnly) {
  const ReturnColumns columns({{.x_est = 1, .y_est = -1}});
  const auto map = gathered(make_accumulator(Method::bilinear4, GridSpec::centered(1, 1)), columns.view(), 1);
  const std::vector<BinValues> v = all_values(*map);
  EXPECT_EQ(v[2].weight_sum, 1);
  EXPECT_EQ(std::ranges::count(v, 0, &BinValues::count), 8);
}

// Passes of few returns give the bits of one pass.
TEST(MedianAccumulator, ManyPassesGiveTheSame) {
  const GridSpec spec = GridSpec::centered(3, 0.25);
  const ReturnColumns columns(random_points(spec, 3000));
  const auto once = all_values(*gathered(std::make_unique<MedianAccumulator>(spec), columns.view(), 500));
  const auto often =
      all_values(*gathered(std::make_unique<MedianAccumulator>(spec, 150), columns.view(), 500));
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].count, often[i].count);
    ASSERT_EQ(std::memcmp(&once[i].z_est, &often[i].z_est, 9 * sizeof(double)), 0);
  }
}

TEST(MedianAccumulator, ProgressRisesToOne) {
  const GridSpec spec = GridSpec::centered(3, 0.25);
  const ReturnColumns columns(random_points(spec, 3000));
  MedianAccumulator map(spec, 500);
  double last = 0;
  int passes = 0;
  do {
    EXPECT_GE(map.progress(0), last - 1e-12);
    map.add(columns.view());
    last = map.progress(1);
    ++passes;
  } while (map.end_pass());
  EXPECT_DOUBLE_EQ(last, 1);
  EXPECT_GT(passes, 5);
}

TEST(MedianAccumulator, RefusesARowOfTooManyReturns) {
  const ReturnColumns columns(std::vector<ReturnPoint>(11, {.y_est = -0.5}));
  MedianAccumulator map(GridSpec::centered(1, 0.5), 10);
  map.add(columns.view());
  EXPECT_EQ(refusal<FormatError>([&] { map.end_pass(); }),
            "method median: the row of bins at y = -0.500000 m holds 11 returns; at most 10 can be sorted "
            "at a time");
}

// The first row, too; as many as can be sorted are taken.
TEST(MedianAccumulator, AsManyReturnsInARowAsCanBeSorted) {
  for (const std::size_t count : {10U, 11U}) {
    const ReturnColumns columns(std::vector<ReturnPoint>(count, {.y_est = -1}));
    MedianAccumulator map(GridSpec::centered(1, 0.5), 10);
    map.add(columns.view());
    if (count == 10)
      EXPECT_TRUE(map.end_pass());
    else
      EXPECT_THROW(map.end_pass(), FormatError);
  }
}

// Returns by row, 10 at a time, and the passes that gather them.
TEST(MedianAccumulator, GathersAsManyRowsAsFit) {
  const auto passes = [](const std::vector<int>& rows) {
    const GridSpec spec{1, 0, 0, std::ssize(rows), 1};
    std::vector<ReturnPoint> points;
    for (std::size_t row = 0; row < rows.size(); ++row)
      for (int i = 0; i < rows[row]; ++i) points.push_back({.y_est = static_cast<double>(row)});
    const ReturnColumns columns(points);
    MedianAccumulator map(spec, 10);
    int count = -1;  // the first one counts
    do {
      map.add(columns.view());
      ++count;
    } while (map.end_pass());
    return count;
  };
  EXPECT_EQ(passes({5, 5}), 1);
  EXPECT_EQ(passes({5, 6}), 2);
  EXPECT_EQ(passes({6, 6, 2, 2}), 2);
  EXPECT_EQ(passes({10, 0, 10, 1}), 3);
}

TEST(MedianAccumulator, TheFirstPassIsATenthOfTheProgress) {
  const ReturnColumns columns(std::vector<ReturnPoint>{{.y_est = 0}, {.y_est = 1}});
  MedianAccumulator map(GridSpec{1, 0, 0, 2, 1}, 1);
  EXPECT_DOUBLE_EQ(map.progress(0.5), 0.05);
  map.add(columns.view());
  map.end_pass();
  EXPECT_DOUBLE_EQ(map.progress(0.5), 0.1 + 0.9 / 4);
  map.add(columns.view());
  map.end_pass();
  EXPECT_DOUBLE_EQ(map.progress(0.5), 0.1 + 0.9 * 3 / 4);
}

/// Counts points without having them.
class CountingAccumulator : public Accumulator {
 public:
  CountingAccumulator() : Accumulator(GridSpec::centered(1, 1)) {}
  using Accumulator::count_points;
  void add(const GridPoints& /*points*/) override {}
  void values(BinIndex /*first*/, std::span<BinValues> /*out*/) const override {}
};

TEST(Accumulator, RefusesMoreReturnsThanABinCanCount) {
  CountingAccumulator map;
  map.count_points(2147483647, 0);
  EXPECT_EQ(map.inside_count(), 2147483647);
  EXPECT_THROW(map.count_points(1, 0), FormatError);
}

}  // namespace
}  // namespace landfall
