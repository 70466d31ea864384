// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/hazard_file.h"

#include <gtest/gtest.h>


namespace landfall {
namespace {

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
  site.distance_to_hazard_m = 4.0F;
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

}  // namespace
}  // namespace landfall
