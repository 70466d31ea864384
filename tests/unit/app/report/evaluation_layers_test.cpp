// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "app/report/evaluation_layers.h"
#include "app/report/report_layer.h"
#include "base/dictionary/layers.h"
#include "bins.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/hazards/safety.h"

namespace landfall::html_report {
namespace {

using testing::ElementsAre;

TEST(Dictionary, EveryLayerOfAReportHasAKnownStyleAndRule) {
  int shown = 0;
  for (const dictionary::Layer& words : dictionary::kLayers) {
    if (std::string(words.title).empty()) continue;
    const ReportLayer layer = described(words.file, words.name);
    EXPECT_EQ(layer_json(layer, "id").at("style"), words.style) << words.name;
    EXPECT_EQ(layer_json(layer, "id").at("rule"), words.rule) << words.name;
    ++shown;
  }
  EXPECT_GT(shown, 30);
}

TEST(Dictionary, UnknownLayersAreRefused) {
  EXPECT_EQ(dictionary::find_layer("dem", "p_safe"), nullptr);
  EXPECT_THROW((void)described("dem", "p_safe"), std::logic_error);
}

TEST(Dictionary, UnitsAreThoseThatPeopleRead) {
  EXPECT_EQ(described("hazards", "slope").unit, "deg");
  EXPECT_EQ(described("hazards", "cost").unit, "");
  EXPECT_EQ(described("dem", "z_est").unit, "m");
}

TEST(Dictionary, PlaceClassesHaveTheValuesOfTheCode) {
  const auto value_of = [](const char* layer, const std::string& name) {
    for (const dictionary::PlaceClass& c : dictionary::place_classes(layer))
      if (c.name == name) return c.value;
    return -1;
  };
  EXPECT_EQ(value_of("safe", "hazard"), static_cast<int>(Safety::hazard));
  EXPECT_EQ(value_of("safe", "safe"), static_cast<int>(Safety::safe));
  EXPECT_EQ(value_of("safe", "unknown"), static_cast<int>(Safety::unknown));
  EXPECT_EQ(value_of("outcome", "hazard found"), static_cast<int>(HazardOutcome::hazard_found));
  EXPECT_EQ(value_of("outcome", "safe found"), static_cast<int>(HazardOutcome::safe_found));
  EXPECT_EQ(value_of("outcome", "missed hazard"), static_cast<int>(HazardOutcome::missed_hazard));
  EXPECT_EQ(value_of("outcome", "false alarm"), static_cast<int>(HazardOutcome::false_alarm));
  EXPECT_EQ(value_of("outcome", "unknown"), static_cast<int>(HazardOutcome::unknown));
}

// The bits are those of old files, too.
TEST(Dictionary, BitsOfTheLayerFail) {
  EXPECT_EQ(fail_relative_x, 1);
  EXPECT_EQ(fail_relative_y, 2);
  EXPECT_EQ(fail_relative_z, 4);
  EXPECT_EQ(fail_absolute_horizontal, 8);
  EXPECT_EQ(fail_hole_size, 16);
  EXPECT_EQ(fail_hole_distance, 32);
  std::vector<int> bits;
  for (const dictionary::FailFlag& flag : fail_flags_by_bit()) bits.push_back(flag.bit);
  EXPECT_THAT(bits, ElementsAre(1, 2, 4, 8, 16, 32));
}

const ReportLayer& layer_named(const ReportLayers& layers, const std::string& name) {
  const auto found = std::ranges::find(layers.layers(), name, &ReportLayer::name);
  EXPECT_NE(found, layers.layers().end()) << name;
  return *found;
}

EvaluationParameters parameters_of_square() {
  EvaluationParameters parameters;
  parameters.region_shape = RegionShape::square;
  parameters.region_half_width_m = 1;
  parameters.footprint_m = 0.5;
  parameters.quantile = 0.99;
  return parameters;
}

DemLayers flat_dem(const GridSpec& spec) {
  DemLayers dem{.z_est = Grid<double>(spec, 2.0), .truth = TrueLayers{}};
  dem.truth->x = dem.truth->y = dem.truth->z = Grid<double>(spec, 2.0);
  for (const auto [row, col] : bins_of(spec)) {
    dem.truth->x.at({row, col}) = spec.x(col);
    dem.truth->y.at({row, col}) = spec.y(row);
  }
  return dem;
}

TEST(ReportLayers, KeepsSingleBadBins) {
  const GridSpec spec = GridSpec::centered(1, 0.1);  // 21 x 21 bins, as 7 x 7 cells
  DemLayers dem = flat_dem(spec);
  dem.z_est.at({10, 10}) = std::nan("");
  dem.truth->z.at({4, 16}) = 1.0;  // an error of -1 m in one bin
  ReportLayers layers(spec, parameters_of_square(), 7);
  layers.take(dem);
  const Evaluation evaluation = evaluate(dem, parameters_of_square(), {&layers});
  EXPECT_EQ(layers.factor(), 3);
  const Quantised& invalid = layer_named(layers, "invalid").values;
  EXPECT_EQ(std::ranges::count(invalid.codes, std::uint16_t{0}), 7 * 7 - 1);
  EXPECT_NEAR(invalid.offset + invalid.step * invalid.codes[3 * 7 + 3], 1.0 / 9, invalid.step);
  const Quantised& error = layer_named(layers, "e_z").values;
  EXPECT_EQ(error.low, -1);
  EXPECT_NEAR(error.offset + error.step * error.codes[1 * 7 + 5], -1, error.step);
  EXPECT_EQ(layers.fail_counts()[2], 25);  // the footprints of 5 x 5 bins that hold it
  EXPECT_EQ(evaluation.metrics.accuracy->relative.z.violation_count, 25);
}

TEST(ReportLayers, CountsTheErrorsOfTheRegion) {
  const GridSpec spec = GridSpec::centered(2, 0.1);
  const DemLayers dem = flat_dem(spec);
  ReportLayers layers(spec, parameters_of_square());
  const Evaluation evaluation = evaluate(dem, parameters_of_square(), {&layers});
  const auto& count = layers.histograms(Axis::z).error.count;
  EXPECT_EQ(std::accumulate(count.begin(), count.end(), std::int64_t{0}),
            *evaluation.metrics.statistics.z.count);
}

TEST(ReportLayers, SharesAreOfTheClosestLimit) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  DemLayers dem = flat_dem(spec);
  for (double& x : dem.truth->x.values()) x += 0.3;  // everywhere: an absolute error, no relative one
  for (double& y : dem.truth->y.values()) y += 0.4;
  ReportLayers layers(spec, parameters_of_square());
  static_cast<void>(evaluate(dem, parameters_of_square(), {&layers}));
  for (const float share : layers.shares().values()) ASSERT_NEAR(share, 0.5, 1e-6);
}

TEST(ReportLayers, HasNoErrorsWithoutTruth) {
  const GridSpec spec = GridSpec::centered(1, 0.1);
  DemLayers dem = flat_dem(spec);
  dem.truth.reset();
  ReportLayers layers(spec, parameters_of_square());
  layers.take(dem);
  static_cast<void>(evaluate(dem, parameters_of_square(), {&layers}));
  std::vector<std::string> names;
  for (const ReportLayer& layer : layers.layers()) names.push_back(layer.name);
  EXPECT_THAT(names, ElementsAre("z_est", "in_region", "invalid", "fail"));
  EXPECT_TRUE(layers.shares().values().empty());
}

TEST(ReportLayers, CountsAreExact) {
  const GridSpec spec = GridSpec::centered(1, 0.5);
  Grid<std::int32_t> count(spec);
  std::iota(count.values().begin(), count.values().end(), 3);
  ReportLayers layers(spec, parameters_of_square());
  layers.take(count);
  const Quantised& values = layers.layers().front().values;
  EXPECT_EQ(values.step, 1);
  EXPECT_EQ(values.offset + values.codes[7], 10);
}

}  // namespace
}  // namespace landfall::html_report
