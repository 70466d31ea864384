// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "base/dictionary/tables/requirements.h"
#include "chain/draws/draw_layers.h"
#include "chain/draws/draw_maps.h"
#include "chain/draws/draw_table.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/hazards/safety.h"
#include "constants.h"

namespace landfall {
namespace {

TEST(DrawTable, AppendsRows) {
  DrawTable table{3,
                  {13, 13},
                  {3, 4},
                  {{"scan.seed", {1, 2}}},
                  {{"a", {5, 6}}, {"requirements.coverage.pass", {1, 0}}},
                  {1, 0}};
  EXPECT_EQ(table.size(), 2);
  EXPECT_EQ(table.end(), 5);
  append(table, {5, {13}, {5}, {{"scan.seed", {3}}}, {{"a", {7}}, {"requirements.coverage.pass", {1}}}, {1}});
  const DrawTable expected{3,
                           {13, 13, 13},
                           {3, 4, 5},
                           {{"scan.seed", {1, 2, 3}}},
                           {{"a", {5, 6, 7}}, {"requirements.coverage.pass", {1, 0, 1}}},
                           {1, 0, 1}};
  EXPECT_EQ(table, expected);
}

TEST(DrawTable, FindsMetrics) {
  const DrawTable table{0, {1}, {0}, {}, {{"a", {5}}, {"requirements.coverage.pass", {1}}}, {1}};
  ASSERT_NE(find_metric(table, "a"), nullptr);
  EXPECT_EQ(find_metric(table, "a")->values.front(), 5);
  EXPECT_EQ(find_metric(table, "b"), nullptr);
  EXPECT_EQ(pass_column(table, "coverage").name, "requirements.coverage.pass");
  EXPECT_THROW(static_cast<void>(pass_column(table, "a")), std::out_of_range);
}

TEST(DrawTable, SixPassedTellsUnjudgedDraws) {
  DrawTable table{0, {1, 1, 1, 1}, {0, 1, 2, 3}, {}, {}, {1, 0, -1, 0}};
  for (const auto& words : dictionary::kRequirements)
    table.metrics.push_back({"requirements." + std::string(words.name) + ".pass", {1, 1, 1, 1}});
  table.metrics[0].values = {1, 0, 1, 1};
  table.metrics[3].values = {1, 1, kNan, kNan};
  table.metrics[5].values = {1, 1, 1, 0};
  EXPECT_EQ(six_passed(table), (std::vector<std::int8_t>{1, 0, -1, 0}));
  EXPECT_EQ(judged_draws(table, std::string(dictionary::kRequirements[3].name)), 2);
  EXPECT_EQ(judged_draws(table, std::string(dictionary::kRequirements[0].name)), 4);
}

constexpr GridSpec kSpec{1, 0, 0, 1, 4};
constexpr double kUnit_m = 0x1p-30;

template <class T>
Grid<T> grid_of(const std::vector<T>& values) {
  Grid<T> grid(kSpec);
  std::ranges::copy(values, grid.values().begin());
  return grid;
}

template <class T>
std::vector<T> values_of(const Grid<T>& grid) {
  return {grid.values().begin(), grid.values().end()};
}

/// Equal, or both NaN.
template <class T>
void expect_same(const Grid<T>& grid, const std::vector<double>& expected) {
  ASSERT_EQ(grid.values().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (std::isnan(expected[i]))
      EXPECT_TRUE(std::isnan(grid.values()[i])) << i;
    else
      EXPECT_FLOAT_EQ(static_cast<float>(grid.values()[i]), static_cast<float>(expected[i])) << i;
  }
}

TEST(ErrorSums, AreThoseOfErrorsRoundedToUnits) {
  ErrorSums sums(kSpec);
  sums.add(1, 3 * kUnit_m);
  sums.add(1, -2.5 * kUnit_m);  // to even: -2
  sums.add(1, 1.5 * kUnit_m);   // to even: 2
  sums.add(2, kNan);
  EXPECT_EQ(values_of(sums.count), (std::vector<std::int32_t>{0, 3, 0, 0}));
  EXPECT_EQ(values_of(sums.sum), (std::vector<std::int64_t>{0, 3, 0, 0}));
  EXPECT_EQ(sums.squares.values()[1], (WideSum{9 + 4 + 4, 0}));
  EXPECT_EQ(sums.squares.values()[2], WideSum{});
}

TEST(ErrorSums, SquaresExceed64Bits) {
  ErrorSums sums(kSpec);
  sums.add(0, 0x1p16);  // (2^46)^2 = 2^92
  sums.add(0, -0x1p16);
  EXPECT_EQ(sums.squares.values()[0], (WideSum{0, std::int64_t{1} << 29U}));
  EXPECT_EQ(sums.mean_m(0), 0);
  EXPECT_EQ(sums.std_m(0), 0x1p16 * std::sqrt(2.0));
  EXPECT_THROW(sums.add(3, std::nextafter(0x1p16, HUGE_VAL)), FormatError);
  EXPECT_THROW(sums.add(3, -HUGE_VAL), FormatError);
  EXPECT_EQ(sums.count.values()[3], 0);
}

TEST(ErrorSums, MeanAndSpread) {
  ErrorSums sums(kSpec);
  for (const double e : {1.0, 2.0, 6.0}) sums.add(0, e);
  sums.add(1, -0.5);
  EXPECT_EQ(sums.mean_m(0), 3);
  EXPECT_DOUBLE_EQ(sums.std_m(0), std::sqrt((4.0 + 1 + 9) / 2));
  EXPECT_EQ(sums.mean_m(1), -0.5);
  EXPECT_TRUE(std::isnan(sums.std_m(1)));
  EXPECT_TRUE(std::isnan(sums.mean_m(2)));
  sums.add(1, -1.5);
  EXPECT_DOUBLE_EQ(sums.std_m(1), std::sqrt(0.5));
  expect_same(mean_of(sums), {3, -1, kNan, kNan});
  expect_same(std_of(sums), {std::sqrt(7), std::sqrt(0.5), kNan, kNan});
  expect_same(std_over_sigma(sums, grid_of<float>({0.5, 0, 1, -1})), {std::sqrt(7) / 0.5, kNan, kNan, kNan});
}

TEST(ErrorSums, DoNotDependOnTheParts) {
  ErrorSums all(kSpec);
  std::vector<ErrorSums> parts(2, ErrorSums(kSpec));
  for (int draw = 0; draw < 40; ++draw)
    for (std::size_t bin = 0; bin < 3; ++bin) {
      const double e = bin == 0 ? -60000.0 : 0.1 * draw - 0.3 * static_cast<double>(bin);
      all.add(bin, e);
      parts[draw < 13 ? 0 : 1].add(bin, e);
    }
  parts[0].merge(parts[1]);
  EXPECT_EQ(values_of(parts[0].count), values_of(all.count));
  EXPECT_EQ(values_of(parts[0].sum), values_of(all.sum));
  EXPECT_EQ(values_of(parts[0].squares), values_of(all.squares));
  EXPECT_NE(all.squares.values()[0].high, 0);
}

Grid<std::int8_t> outcome(const std::vector<HazardOutcome>& values) {
  Grid<std::int8_t> grid(kSpec);
  std::ranges::transform(values, grid.values().begin(),
                         [](HazardOutcome value) { return static_cast<std::int8_t>(value); });
  return grid;
}

TEST(SafetyCounts, CountsKnownSafeAndMissedPlaces) {
  using enum HazardOutcome;
  SafetyCounts safety(kSpec);
  safety.add(outcome({hazard_found, safe_found, missed_hazard, unknown}));
  safety.add(outcome({false_alarm, safe_found, safe_found, unknown}));
  safety.add(outcome({unknown, missed_hazard, hazard_found, unknown}));
  EXPECT_EQ(values_of(safety.known), (std::vector<std::int32_t>{2, 3, 3, 0}));
  EXPECT_EQ(values_of(safety.judged_safe), (std::vector<std::int32_t>{0, 3, 2, 0}));
  EXPECT_EQ(values_of(safety.missed), (std::vector<std::int32_t>{0, 1, 1, 0}));
  expect_same(share_of_known(safety, safety.judged_safe), {0, 1, 2.0 / 3, kNan});
  SafetyCounts more(kSpec);
  more.add(outcome({missed_hazard, unknown, safe_found, hazard_found}));
  expect_same(share_of_known(more, more.missed), {1, kNan, 0, 0});
  more.merge(safety);
  EXPECT_EQ(values_of(more.known), (std::vector<std::int32_t>{3, 3, 4, 1}));
  EXPECT_EQ(values_of(more.judged_safe), (std::vector<std::int32_t>{1, 3, 3, 0}));
  EXPECT_EQ(values_of(more.missed), (std::vector<std::int32_t>{1, 1, 1, 0}));
}

DrawnDem dem_of(const std::vector<double>& z_est, const std::vector<double>& z_true,
                const std::vector<std::int32_t>& count) {
  DrawnDem dem;
  dem.layers.z_est = grid_of(z_est);
  dem.layers.truth = TrueLayers{Grid<double>(kSpec), Grid<double>(kSpec), grid_of(z_true)};
  dem.count = grid_of(count);
  return dem;
}

/// Three draws of four bins.
DrawMaps some_maps(int first, int end) {
  DrawMaps maps(kSpec);
  maps.safety.emplace(kSpec);
  const Grid<double> map = grid_of<double>({10, 20, kNan, 40});
  for (int draw = first; draw < end; ++draw) {
    const double z = draw;
    maps.add_dem(dem_of({z, kNan, z, draw == 1 ? kNan : 5}, {1, 2, 3, kNan}, {draw + 1, 0, 2, 3}), &map);
    const auto flags = [&](int value) { return static_cast<std::int8_t>(value); };
    maps.add_verdicts(grid_of<std::int8_t>({flags(fail_relative_x), flags(fail_relative_y),
                                            flags(draw == 2 ? fail_relative_z | fail_absolute_horizontal : 0),
                                            flags(draw == 0 ? 15 : fail_hole_distance)}));
    maps.safety->add(Grid<std::int8_t>(kSpec, static_cast<std::int8_t>(HazardOutcome::missed_hazard)));
  }
  return maps;
}

TEST(DrawMaps, CountsDrawsAndErrors) {
  const DrawMaps maps = some_maps(0, 3);
  EXPECT_EQ(maps.draws, 3);
  EXPECT_EQ(maps.spec(), kSpec);
  EXPECT_EQ(values_of(maps.invalid), (std::vector<std::int32_t>{0, 3, 0, 1}));
  EXPECT_EQ(values_of(maps.count), (std::vector<std::int64_t>{6, 0, 6, 9}));
  EXPECT_EQ(values_of(maps.failing[0]), (std::vector<std::int32_t>{3, 0, 0, 1}));
  EXPECT_EQ(values_of(maps.failing[1]), (std::vector<std::int32_t>{0, 3, 0, 1}));
  EXPECT_EQ(values_of(maps.failing[2]), (std::vector<std::int32_t>{0, 0, 1, 1}));
  EXPECT_EQ(values_of(maps.failing[3]), (std::vector<std::int32_t>{0, 0, 1, 1}));
  expect_same(mean_of(maps.e_z), {0, kNan, 2, kNan});      // truth - z
  expect_same(mean_of(*maps.e_map), {9, kNan, kNan, 35});  // H - z
  EXPECT_EQ(values_of(maps.e_z.count), (std::vector<std::int32_t>{3, 0, 3, 0}));
  EXPECT_EQ(values_of(maps.e_map->count), (std::vector<std::int32_t>{3, 0, 0, 2}));
  expect_same(mean_count(maps), {2, 0, 2, 3});
  expect_same(share_of_draws(maps.invalid, 3, nullptr), {0, 1, 0, 1.0 / 3});
  const BinMask region = grid_of<std::int8_t>({1, 0, 1, 1});
  expect_same(share_of_draws(maps.invalid, 3, &region), {0, kNan, 0, 1.0 / 3});
  expect_same(share_of_draws(maps.failing[0], 0, nullptr), {kNan, kNan, kNan, kNan});
  std::string layers;
  for (const FailureMap& map : failure_maps(maps))
    layers += std::string(map.layer) + " " + map.requirement + " ";
  EXPECT_EQ(
      layers,
      "p_fail_rel_x relative_horizontal p_fail_rel_y relative_horizontal p_fail_rel_z relative_elevation "
      "p_fail_absolute absolute_horizontal ");
}

TEST(DrawMaps, DoNotDependOnTheParts) {
  const DrawMaps all = some_maps(0, 3);
  DrawMaps merged = some_maps(0, 1);
  merged.merge(some_maps(1, 3));
  EXPECT_EQ(merged.draws, all.draws);
  EXPECT_EQ(values_of(merged.invalid), values_of(all.invalid));
  for (std::size_t k = 0; k < all.failing.size(); ++k)
    EXPECT_EQ(values_of(merged.failing[k]), values_of(all.failing[k]));
  EXPECT_EQ(values_of(merged.count), values_of(all.count));
  EXPECT_EQ(values_of(merged.e_z.sum), values_of(all.e_z.sum));
  EXPECT_EQ(values_of(merged.e_map->squares), values_of(all.e_map->squares));
  EXPECT_EQ(values_of(merged.safety->missed), (std::vector<std::int32_t>{3, 3, 3, 3}));
}

}  // namespace
}  // namespace landfall
