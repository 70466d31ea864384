// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/metrics_json.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "judged.h"

namespace landfall {
namespace {

TEST(MetricsJson, WithoutTruthTheStructureStaysAndItsNumbersAreNull) {
  const auto json = metrics_json(Metrics{});
  EXPECT_TRUE(json.at("pass").is_null());
  const auto& accuracy = json.at("accuracy");
  EXPECT_TRUE(accuracy.at("footprint_bins").is_null());
  EXPECT_TRUE(accuracy.at("absolute").at("y").at("mean_m").is_null());
  EXPECT_TRUE(accuracy.at("absolute").at("horizontal").at("within_limit_frac").is_null());
  EXPECT_TRUE(accuracy.at("relative").at("z").at("violation_count").is_null());
  EXPECT_TRUE(json.at("requirements").at("coverage").at("value").is_null());
  EXPECT_TRUE(json.at("statistics").at("z").at("count").is_null());
  EXPECT_TRUE(json.at("statistics").at("horizontal").at("ce90_m").is_null());
}

TEST(MetricsJson, StatisticsAndTheCorrectedElevation) {
  Metrics metrics;
  EXPECT_FALSE(metrics_json(metrics).at("statistics").contains("z_corrected"));
  metrics.accuracy.emplace();
  metrics.statistics.z_corrected = ErrorStatistics{2, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  metrics.accuracy->absolute.z_corrected = AbsoluteMetrics{1.0, 2.0, 3.0};
  metrics.accuracy->relative.z_corrected = RelativeMetrics{4.0, 5.0, 6};
  const auto json = metrics_json(metrics);
  EXPECT_EQ(
      json.at("statistics").at("z_corrected").dump(),
      R"({"count":2,"mean_m":0.1,"std_m":0.2,"rmse_m":0.3,"median_m":0.4,"nmad_m":0.5,"le90_m":0.6,"p95_m":0.7})");
  EXPECT_EQ(json.at("accuracy").at("absolute").at("z_corrected").at("max_m"), 3.0);
  EXPECT_EQ(json.at("accuracy").at("relative").at("z_corrected").at("violation_count"), 6);
}

TEST(MetricsJson, WhatIsNotFiniteIsNull) {
  Metrics metrics;
  metrics.coverage.max_distance_bins = std::numeric_limits<double>::infinity();
  metrics.coverage.invalid_frac = std::numeric_limits<double>::quiet_NaN();
  set(metrics.requirements["hole_distance"], {std::numeric_limits<double>::infinity(), 1, false});
  const auto json = metrics_json(metrics);
  EXPECT_TRUE(json.at("coverage").at("max_distance_bins").is_null());
  EXPECT_TRUE(json.at("coverage").at("invalid_frac").is_null());
  EXPECT_TRUE(json.at("requirements").at("hole_distance").at("value").is_null());
  EXPECT_EQ(json.at("requirements").at("hole_distance").at("pass"), false);
}

TEST(MetricsJson, OwnRequirementsAreReadAgain) {
  Metrics metrics;
  judge_own_requirements(metrics,
                         {{"x y", "coverage.hole_count", 2, false}, {"z", "statistics.x.le90_m", 1, true}});
  const auto json = metrics_json(metrics);
  EXPECT_EQ(json.at("own_requirements").dump(),
            R"({"x y":{"metric":"coverage.hole_count","value":0.0,"limit":2.0,"at_least":false,"pass":true},)"
            R"("z":{"metric":"statistics.x.le90_m","value":null,"limit":1.0,"at_least":true,"pass":false}})");
  EXPECT_EQ(json.at("pass"), false);
  EXPECT_EQ(metrics_from(json).own_requirements, metrics.own_requirements);
  EXPECT_FALSE(metrics_json(Metrics{}).contains("own_requirements"));
}

TEST(MetricsJson, NumbersKeepTheirPlaceAndOrder) {
  Metrics metrics;
  metrics.pass = true;
  metrics.coverage.hole_size_histogram = {{1, 4}, {7, 2}};
  metrics.accuracy.emplace();
  metrics.accuracy->footprint_bins = 35;
  metrics.accuracy->quantile = 0.95;
  metrics.accuracy->absolute.x = {0.1, -0.2, 0.3};
  metrics.accuracy->relative.z = {0.4, 0.5, 6};
  set(metrics.requirements["absolute_horizontal"], {0.97, 0.95, true});
  const auto json = metrics_json(metrics);
  EXPECT_EQ(json.at("coverage").at("hole_size_histogram").dump(), R"({"size_bins":[1,4],"count":[7,2]})");
  EXPECT_EQ(json.at("accuracy").at("absolute").at("x").dump(), R"({"p95_m":0.1,"mean_m":-0.2,"max_m":0.3})");
  EXPECT_EQ(json.at("accuracy").at("relative").at("z").dump(),
            R"({"p95_m":0.4,"max_m":0.5,"violation_count":6})");
  EXPECT_EQ(json.at("requirements").at("absolute_horizontal").dump(),
            R"({"value":0.97,"limit":0.95,"pass":true})");
  EXPECT_EQ(json.dump().substr(0, 56), R"({"format":"landfall.metrics","version":2,"pass":true,"re)");
}

Metrics with_all_fields() {
  Metrics m;
  m.pass = false;
  m.region = {RegionShape::square, std::nullopt, 5.0, 121};
  m.assumptions = AssumptionMetrics{35, 0.1, 2.5, 0.25};
  m.coverage = {3, 3.0 / 121, 2, 2, 1, 1.5, 4, {{1, 2}, {1, 1}}};
  m.accuracy.emplace();
  m.accuracy->footprint_bins = 35;
  m.accuracy->quantile = 0.9;
  m.accuracy->absolute = {{0.1, -0.2, 0.3}, {}, {0.4, 0.5, 0.6}, AbsoluteMetrics{7.0, 8.0, 9.0}, {0.7, 0.8}};
  m.accuracy->relative = {{1.0, 2.0, 3}, {4.0, 5.0, 6}, {7.0, 8.0, 9}, RelativeMetrics{1.0, 2.0, 30}};
  m.statistics = {0.99, {1, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0}, {}, {}, ErrorStatistics{2}, {3, 4.0, 5.0}};
  for (RequirementVerdict& verdict : m.requirements.all) set(verdict, {0.5, 0.25, true});
  set(m.requirements["relative_elevation"], {std::nullopt, 0, std::nullopt, kFootprintBins});
  m.requirements["hole_distance"].value = m.coverage.max_distance_bins;
  m.uncertainty.emplace();
  m.uncertainty->absolute = {
      4, 1, 0.1, 1.1, 0.6, 0.9, {{2}, {4}, {1.1}, {0.6}, {0.9}}, {{0.1}, {0.2}, {4}}, {{1}, {0.6}}};
  return m;
}

TEST(MetricsJson, ReadsWhatItWrote) {
  Metrics without_truth = with_all_fields();
  without_truth.accuracy.reset();
  without_truth.uncertainty.reset();
  without_truth.statistics.z_corrected.reset();
  Metrics without_valid_bin;
  without_valid_bin.region.shape = RegionShape::mask;
  without_valid_bin.coverage.max_distance_bins = std::numeric_limits<double>::infinity();
  set(without_valid_bin.requirements["hole_distance"], {std::numeric_limits<double>::infinity(), 1, false});
  for (const Metrics& metrics : {with_all_fields(), without_truth, without_valid_bin}) {
    const auto json = metrics_json(metrics);
    EXPECT_EQ(metrics_from(json), metrics) << json;
    EXPECT_EQ(metrics_from(nlohmann::ordered_json::parse(json.dump())), metrics);
    EXPECT_EQ(metrics_json(metrics_from(json)).dump(), json.dump());
  }
}

TEST(MetricsJson, OnlyARequirementThatIsNotJudgedHasAReason) {
  const auto json = metrics_json(with_all_fields());
  EXPECT_EQ(json.at("requirements").at("relative_elevation").dump(),
            R"({"value":null,"limit":0.0,"pass":null,"reason":"footprint_bins"})");
  EXPECT_FALSE(json.at("requirements").at("relative_horizontal").contains("reason"));
  EXPECT_EQ(
      json.at("assumptions").dump(),
      R"({"footprint_bins":35,"truth_spacing_m":0.1,"median_returns_per_bin":2.5,"single_return_frac":0.25})");
}

TEST(MetricsJson, ReadsVersion1) {
  auto json = metrics_json(with_all_fields());
  json["version"] = 1;
  json.erase("assumptions");
  json["requirements"]["relative_elevation"].erase("reason");
  Metrics expected = with_all_fields();
  expected.assumptions.reset();
  expected.requirements["relative_elevation"].reason.reset();
  EXPECT_EQ(metrics_from(json), expected);
}

TEST(MetricsJson, RequirementsAreThoseOfTheTable) {
  std::vector<std::string> names;
  for (const auto& words : dictionary::kRequirements) names.emplace_back(words.name);
  std::vector<std::string> keys;
  const auto json = metrics_json(with_all_fields());
  for (const auto& [key, unused] : json.at("requirements").items()) keys.push_back(key);
  EXPECT_EQ(keys, names);
}

TEST(MetricsJson, RefusesWhatItDoesNotWrite) {
  const auto good = metrics_json(with_all_fields());
  const auto refused = [&](const char* pointer, const nlohmann::ordered_json& value) {
    auto json = good;
    json.at(nlohmann::ordered_json::json_pointer(pointer)) = value;
    EXPECT_THROW(static_cast<void>(metrics_from(json)), nlohmann::json::exception) << pointer << value;
  };
  refused("/pass", 3);
  refused("/region", nullptr);
  refused("/region/bin_count", 1e300);
  refused("/coverage/invalid_frac", "0");
  refused("/coverage/hole_size_histogram/count", 3);
  refused("/coverage/hole_size_histogram/count", {1.5});
  refused("/accuracy/quantile", nlohmann::ordered_json::array());
  refused("/requirements/hole_size/limit", "10");
  for (const auto& json :
       {nlohmann::ordered_json(), nlohmann::ordered_json::object(), nlohmann::ordered_json(3)})
    EXPECT_THROW(static_cast<void>(metrics_from(json)), nlohmann::json::exception);
  auto json = good;
  json.at("statistics").erase("valid_frac");
  EXPECT_THROW(static_cast<void>(metrics_from(json)), nlohmann::json::exception);
}

}  // namespace
}  // namespace landfall
