// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/plan_file.h"

#include <gtest/gtest.h>

#include "store/files/field_json.h"

namespace landfall {
namespace {

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
