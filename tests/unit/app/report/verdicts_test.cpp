// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "app/report/verdicts.h"
#include "app/report/worst_footprints.h"
#include "bins.h"
#include "chain/evaluation/evaluate.h"
#include "judged.h"

namespace landfall::html_report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Metrics metrics_of() {
  Metrics metrics;
  const Judged judged[] = {{0.012, 0.01, false}, {1, 10, true}, {1, 1, true},
                           {0, 0, true},         {3, 0, false}, {0.97, 0.95, true}};
  for (std::size_t i = 0; i < metrics.requirements.all.size(); ++i)
    set(metrics.requirements.all[i], judged[i]);
  metrics.pass = false;
  metrics.accuracy.emplace();
  return metrics;
}

TEST(VerdictTable, HasTheWordsOfTheTerminal) {
  Metrics metrics = metrics_of();
  metrics.region.bin_count = 1000;
  metrics.coverage.invalid_count = 12;
  metrics.coverage.invalid_frac = 0.012;
  const std::string table = verdict_table_html(metrics, {});
  EXPECT_THAT(table, HasSubstr("<td>12 of 1,000 bins invalid, 1.2 %</td><td class=\"number\">1 %</td>"
                               "<td><span class=\"verdict fail\">FAIL</span>"));
  EXPECT_THAT(table, HasSubstr("<td class=\"number\">&gt;= 95 %</td>"));
}

TEST(VerdictTable, LeavesOpenWhatIsNotJudged) {
  Metrics metrics = metrics_of();
  metrics.accuracy.reset();
  for (RequirementVerdict* const r :
       {&metrics.requirements["relative_elevation"], &metrics.requirements["relative_horizontal"],
        &metrics.requirements["absolute_horizontal"]})
    set(*r, {std::nullopt, 0, std::nullopt});
  EXPECT_THAT(verdict_table_html(metrics, {}),
              HasSubstr("<td>no truth to compare with</td><td class=\"number\">5 cm</td>"
                        "<td><span class=\"verdict unjudged\">not judged</span>"));
}

TEST(Assumptions, AreAParagraph) {
  EXPECT_EQ(assumptions_html({35, 0.05}),
            "<p class=\"note\" id=\"assumptions\">Assumptions: footprint of 35 x 35 bins; truth nodes every "
            "0.05 m.</p>");
}

TEST(VerdictBanner, CountsTheMissedOnes) {
  EXPECT_THAT(verdict_banner_html(metrics_of()), HasSubstr("FAIL: 2 of 6 requirements missed<"));
  Metrics metrics = metrics_of();
  for (RequirementVerdict* const r :
       {&metrics.requirements["coverage"], &metrics.requirements["relative_horizontal"]})
    r->pass = true;
  metrics.pass = true;
  EXPECT_THAT(verdict_banner_html(metrics), HasSubstr("class=\"banner pass\" id=\"verdict\">pass: all 6"));
  metrics.requirements["relative_elevation"].pass = std::nullopt;
  metrics.pass = std::nullopt;
  EXPECT_THAT(verdict_banner_html(metrics), HasSubstr("class=\"banner unjudged\""));
  metrics.requirements["relative_elevation"].reason = kFootprintBins;
  EXPECT_THAT(verdict_banner_html(metrics),
              HasSubstr("not judged: 1 of 6 not judged: the footprint has fewer than 5 x 5 bins<"));
  metrics.requirements["coverage"].pass = false;
  EXPECT_THAT(verdict_banner_html(metrics), HasSubstr("FAIL: 1 of 6 requirements missed, 1 of 6 not judged"));
}

constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();

/// All bins in the order of their values, each taken unless it is too near to one taken before.
std::vector<BinIndex> by_sorting(const Grid<float>& map, std::int64_t half_bins, std::size_t count) {
  std::vector<BinIndex> bins;
  for (const BinIndex bin : bins_of(map.spec()))
    if (!std::isnan(map.at(bin))) bins.push_back(bin);
  std::ranges::stable_sort(bins, [&](BinIndex a, BinIndex b) { return map.at(a) > map.at(b); });
  std::vector<BinIndex> chosen;
  for (const BinIndex bin : bins) {
    const auto near = [&](BinIndex other) {
      return std::abs(bin.row - other.row) <= 2 * half_bins && std::abs(bin.col - other.col) <= 2 * half_bins;
    };
    if (chosen.size() < count && std::ranges::none_of(chosen, near)) chosen.push_back(bin);
  }
  return chosen;
}

TEST(LargestApart, IsWhatSortingGives) {
  std::mt19937 generator(17);
  for (const std::int64_t half : {0, 1, 4}) {
    Grid<float> map({1, 0, 0, 140, 90});
    // Few different values, so that many are equal.
    for (float& value : map.values()) {
      const auto drawn = static_cast<int>(generator() % 40);
      value = drawn == 0 ? kFloatNan : static_cast<float>(drawn);
    }
    EXPECT_EQ(largest_apart(map, half, 10), by_sorting(map, half, 10)) << half;
  }
}

TEST(LargestApart, TakesAsManyAsThereAre) {
  EXPECT_THAT(largest_apart(Grid<float>({1, 0, 0, 3, 3}, kFloatNan), 1, 10), IsEmpty());
  EXPECT_THAT(largest_apart(Grid<float>({1, 0, 0, 3, 3}, 0), 1, 10), ElementsAre(BinIndex{0, 0}));
}

TEST(ShareOfLimit, IsInfiniteWithoutALimit) {
  EXPECT_DOUBLE_EQ(share_of_limit(0.03, 0.05), 0.6);
  EXPECT_EQ(share_of_limit(0.03, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(share_of_limit(0, 0), 0);
  EXPECT_TRUE(std::isnan(share_of_limit(std::nan(""), 0.05)));
}

/// A DEM of 41 x 41 bins of 10 cm with errors in x, y and z.
DemLayers dem_of(const GridSpec& spec) {
  DemLayers dem{.z_est = Grid<double>(spec, 5.0), .truth = TrueLayers{}};
  dem.truth->x = dem.truth->y = dem.truth->z = Grid<double>(spec);
  for (const auto [row, col] : bins_of(spec)) {
    const auto i = static_cast<double>(spec.first_row + row);
    const auto k = static_cast<double>(spec.first_col + col);
    dem.truth->x.at({row, col}) = spec.x(col) + 0.01 * std::sin(0.7 * i + k);
    dem.truth->y.at({row, col}) = spec.y(row) + 0.02 * std::cos(i * k);
    dem.truth->z.at({row, col}) = 5.0 + 0.03 * std::sin(0.2 * i * i + 0.5 * k);
    if ((row + 2 * col) % 13 == 0) dem.z_est.at({row, col}) = std::nan("");
  }
  return dem;
}

struct LayerKeeper : LayerSink {
  void take(const CoverageLayers& /*layers*/) override {}
  void take(Axis axis, const AxisLayers& layers) override { axes[static_cast<std::size_t>(axis)] = layers; }
  void take(const Grid<std::int8_t>& /*fail*/) override {}
  AxisLayers axes[3];
};

TEST(MeasureFootprint, FindsWhatTheEvaluationFound) {
  const GridSpec spec = GridSpec::centered(2, 0.1);
  EvaluationParameters parameters;
  parameters.region_shape = RegionShape::square;
  parameters.region_half_width_m = 2;
  parameters.footprint_m = 0.5;
  const DemLayers dem = dem_of(spec);
  LayerKeeper kept;
  static_cast<void>(evaluate(dem, parameters, {&kept}));
  const DemWindow read = [&](const GridSpec& window) {
    DemLayers part{.z_est = Grid<double>(window), .truth = TrueLayers{}};
    part.truth->x = part.truth->y = part.truth->z = Grid<double>(window);
    for (const auto [row, col] : bins_of(window)) {
      const BinIndex bin{window.first_row + row - spec.first_row, window.first_col + col - spec.first_col};
      part.z_est.at({row, col}) = dem.z_est.at(bin);
      part.truth->x.at({row, col}) = dem.truth->x.at(bin);
      part.truth->y.at({row, col}) = dem.truth->y.at(bin);
      part.truth->z.at({row, col}) = dem.truth->z.at(bin);
    }
    return part;
  };
  for (const BinIndex bin : {BinIndex{20, 20}, BinIndex{0, 0}, BinIndex{40, 17}}) {
    const WorstFootprint found = measure_footprint(bin, spec, parameters, read);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(static_cast<float>(found.absolute_m[axis]), kept.axes[axis].absolute.at(bin)) << axis;
      EXPECT_EQ(static_cast<float>(found.relative_m[axis]), kept.axes[axis].relative.at(bin)) << axis;
    }
    EXPECT_DOUBLE_EQ(found.horizontal_m, std::hypot(found.absolute_m[0], found.absolute_m[1]));
    const double shares[] = {found.relative_m[2] / 0.05, found.relative_m[0] / 0.05,
                             found.relative_m[1] / 0.05, found.horizontal_m / 1};
    EXPECT_DOUBLE_EQ(found.share, *std::ranges::max_element(shares));
    EXPECT_EQ(found.error.spec(), found.window);
  }
}

TEST(WorstFootprints, AreNoneWithoutShares) { EXPECT_THAT(worst_footprints({}, {}, {}), IsEmpty()); }

}  // namespace
}  // namespace landfall::html_report
