// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <span>
#include <sstream>

#include "store/files/field_json.h"
#include "store/files/hazard_file.h"
#include "store/files/plan_file.h"
#include "store/files/terrain_file.h"
#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::_;
using testing::ElementsAre;
using testing::IsNan;

// The order of the keys is part of the format.
TEST(SitesJson, AMemberForEachNumber) {
  HazardMap map;
  EXPECT_EQ(sites_json(map).dump(),
            R"({"format":"landfall.sites","version":1,"probability":false,"sites":[]})");
  LandingSite site;
  site.x_m = 1.5;
  site.y_m = -2;
  site.z_m = 0.25;
  site.cost = 0.5F;
  site.p_touchdown = 0.75F;
  site.slope_deg = 3;
  site.roughness_m = -0.5;
  map.sites.push_back(site);
  site.p_safe = 0.125F;
  site.hazard_distance_m = 4.0F;
  site.truth = Safety::safe;
  map.sites.push_back(site);
  site.truth = Safety::hazard;
  map.sites.push_back(site);
  const nlohmann::ordered_json sites = sites_json(map).at("sites");
  EXPECT_EQ(
      sites.at(0).dump(),
      R"({"rank":1,"x_m":1.5,"y_m":-2.0,"z_m":0.25,"cost":0.5,"p_touchdown":0.75,"p_safe":null,"slope_deg":3.0,)"
      R"("roughness_m":-0.5,"distance_to_hazard_m":null,"true_safe":null,"p_capped":null})");
  EXPECT_EQ(
      sites.at(1).dump(),
      R"({"rank":2,"x_m":1.5,"y_m":-2.0,"z_m":0.25,"cost":0.5,"p_touchdown":0.75,"p_safe":0.125,"slope_deg":3.0,)"
      R"("roughness_m":-0.5,"distance_to_hazard_m":4.0,"true_safe":true,"p_capped":false})");
  EXPECT_EQ(sites.at(2).at("true_safe"), false);
}

TEST(ScoreJson, FractionsOfNothingAreNull) {
  EXPECT_EQ(
      score_json({}).dump(),
      R"({"format":"landfall.hazard_score","version":1,"counts":{"safe_safe":0,"safe_hazard":0,"hazard_safe":0,)"
      R"("hazard_hazard":0,"unknown":0},"filled_truth_bins":0,"missed_hazard_frac":null,"false_alarm_frac":null,)"
      R"("roc":{"roughness_limit_m":[],"missed_hazard_frac":[],"false_alarm_frac":[]},"brier":null,)"
      R"("reliability":{"p_low":[],"p_high":[],"count":[],"safe_frac":[]}})");
}

TEST(ScoreJson, EachNumberHasItsPlace) {
  HazardScore score;
  score.counts = {1, 2, 3, 4, 5};
  score.filled_truth_bins = 6;
  score.rates = {0.25, 0.5};
  score.roc = {{0.1, {0.75, std::nullopt}}};
  score.brier = 0.125;
  score.reliability = {{0.5, 0.625, 7, 0.875}};
  EXPECT_EQ(
      score_json(score).dump(),
      R"({"format":"landfall.hazard_score","version":1,"counts":{"safe_safe":1,"safe_hazard":2,"hazard_safe":3,)"
      R"("hazard_hazard":4,"unknown":5},"filled_truth_bins":6,"missed_hazard_frac":0.25,"false_alarm_frac":0.5,)"
      R"("roc":{"roughness_limit_m":[0.1],"missed_hazard_frac":[0.75],"false_alarm_frac":[null]},"brier":0.125,)"
      R"("reliability":{"p_low":[0.5],"p_high":[0.625],"count":[7],"safe_frac":[0.875]}})");
}

std::vector<PlacedFeature> one_of_each() {
  return {{{1, 2, Rock{3, 1.25, 0.8, 0.5}}, -1, 0, 7.5},
          {{-100, 0, Crater{10, 1.5, 0.5}}, -1, 1, std::nullopt},
          {{0, -3, PenitenteField{}}, 2, 4'000'000'000, -0.25}};
}

void write(const std::filesystem::path& path, const std::vector<PlacedFeature>& features) {
  LandfallFileWriter file({path, true, 1}, "terrain", {.tool = "test"});
  write_features(file, features);
  file.commit();
}

template <class T>
std::vector<T> read(const std::filesystem::path& path, const char* column) {
  const LandfallFileReader file(path, {"terrain"});
  const TableReader table(file.root(), "features", file.name());
  std::vector<T> values(table.row_count(column));
  table.read(column, 0, std::span(values));
  return values;
}

TEST(FeatureFile, RoundTrip) {
  const TemporaryFolder folder;
  write(folder / "a.h5", one_of_each());
  const auto path = folder / "a.h5";
  EXPECT_THAT(read<double>(path, "x"), ElementsAre(1, -100, 0));
  EXPECT_THAT(read<double>(path, "y"), ElementsAre(2, 0, -3));
  EXPECT_THAT(read<double>(path, "ground"), ElementsAre(7.5, IsNan(), -0.25));
  EXPECT_THAT(read<double>(path, "diameter"), ElementsAre(3, 10, _));
  EXPECT_THAT(read<double>(path, "height"), ElementsAre(1.25, -0.75, _));
  EXPECT_THAT(read<double>(path, "yaw"), ElementsAre(0.5, _, _));
  EXPECT_THAT(read<std::int32_t>(path, "pattern"), ElementsAre(-1, -1, 2));
  EXPECT_THAT(read<std::int64_t>(path, "number"), ElementsAre(0, 1, 4'000'000'000));
  const LandfallFileReader file(path, {"terrain"});
  const h5::Handle kind = h5::open_dataset(file.root(), "features/kind");
  std::istringstream words(h5::read_text_attribute(kind.get(), "flag_meanings").value());
  const std::vector<std::string> kinds(std::istream_iterator<std::string>(words), {});
  std::vector<std::string> found;
  for (const std::int8_t index : read<std::int8_t>(path, "kind"))
    found.push_back(kinds.at(static_cast<std::size_t>(index)));
  EXPECT_THAT(found, ElementsAre("rock", "crater", "penitente_field"));
}

TEST(FeatureFile, ManyRows) {
  const TemporaryFolder folder;
  std::vector<PlacedFeature> features;
  for (std::int64_t i = 0; i < 2 * static_cast<std::int64_t>(kTableChunkRows) + 5; ++i)
    features.push_back({{0.5 * static_cast<double>(i), 0, Rock{}}, 0, i, 0.0});
  write(folder / "a.h5", features);
  const auto x_m = read<double>(folder / "a.h5", "x");
  const auto number = read<std::int64_t>(folder / "a.h5", "number");
  ASSERT_EQ(number.size(), features.size());
  for (std::size_t i = 0; i < number.size(); ++i) {
    ASSERT_EQ(x_m[i], features[i].feature.x_m);
    ASSERT_EQ(number[i], features[i].number);
  }
}

TEST(FeatureFile, NoObjectsNoGroup) {
  const TemporaryFolder folder;
  write(folder / "a.h5", {});
  const LandfallFileReader file(folder / "a.h5", {"terrain"});
  EXPECT_FALSE(h5::exists(file.root(), "features"));
}

PlanMetrics some_plan() {
  PlanMetrics plan;
  plan.region = {50, 0.5, 900};
  plan.time = {{40, 4, 1}, {20, 2, 0.5}, {10, 1, 0.25}, {6, 0.6, 0.15}, {4, 0.4, 0.1}};
  plan.returns = {1000, 700, 600};
  plan.coverage.invalid_count = 300;
  plan.coverage.invalid_frac = 0.25;
  plan.coverage.hole_count = 5;
  plan.coverage.largest_hole_bins = 7;
  plan.coverage.max_distance_bins = 2.5;
  plan.returns_per_bin = {1.5, 0, 0, 1, 3, 4, 0.125};
  plan.frames_per_bin = {1.25, 0, 0, 1, 2, 3, 0.5};
  return plan;
}

TEST(PlanJson, HasItsKeysInOrder) {
  EXPECT_EQ(
      fields_json(some_plan()).dump(),
      R"({"region":{"radius_m":50.0,"resolution_m":0.5,"bin_count":900},)"
      R"("time":{"total":{"pulse_count":40,"time_s":4.0,"frac":1.0},)"
      R"("in_region":{"pulse_count":20,"time_s":2.0,"frac":0.5},)"
      R"("partly_in_region":{"pulse_count":10,"time_s":1.0,"frac":0.25},)"
      R"("off_region":{"pulse_count":6,"time_s":0.6,"frac":0.15},)"
      R"("blanked":{"pulse_count":4,"time_s":0.4,"frac":0.1}},)"
      R"("returns":{"count":1000,"in_region":700,"first_in_bin":600},)"
      R"("coverage":{"uncovered_count":300,"uncovered_frac":0.25,"hole_count":5,)"
      R"("largest_hole_bins":7,"max_distance_bins":2.5},)"
      R"("returns_per_bin":{"mean":1.5,"min":0,"p05":0,"median":1,"p95":3,"max":4},)"
      R"("frames_per_bin":{"mean":1.25,"min":0,"p05":0,"median":1,"p95":2,"max":3,"overlap_frac":0.5}})");
}

TEST(PlanJson, ReadsWhatItWrote) {
  const auto json = fields_json(some_plan());
  const PlanMetrics plan = fields_from<PlanMetrics>(json);
  EXPECT_EQ(fields_json(plan).dump(), json.dump());
  EXPECT_EQ(plan.coverage.invalid_count, 300);
  EXPECT_EQ(plan.frames_per_bin.above_one_frac, 0.5);
}

TEST(PlanJson, RefusesWhatItDoesNotWrite) {
  auto json = fields_json(some_plan());
  json.at("frames_per_bin").erase("overlap_frac");
  EXPECT_THROW(static_cast<void>(fields_from<PlanMetrics>(json)), nlohmann::json::exception);
  EXPECT_THROW(static_cast<void>(fields_from<PlanMetrics>(nlohmann::ordered_json())),
               nlohmann::json::exception);
}

}  // namespace
}  // namespace landfall
