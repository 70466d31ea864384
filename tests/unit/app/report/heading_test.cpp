// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/heading.h"

#include <gtest/gtest.h>

namespace landfall::html_report {
namespace {

using Json = nlohmann::json;

Json terrain(const Json& config) { return {{"tool", "terrain-gen"}, {"config", config}}; }

TEST(Heading, NamesSiteAndLidar) {
  const Json steps = {
      terrain(
          {{"base", {{{"type", "dem"}, {"path", "mars.tif"}}, {{"type", "fractal"}}}},
           {"patterns", {{{"type", "golombek_rocks"}}, {{"type", "ring"}, {"feature", {{"type", "cone"}}}}}},
           {"grid", {{"half_width_m", 40}, {"resolution_m", 0.05}}}}),
      {{"tool", "scan-sim"},
       {"config",
        {{"scanner", {{"type", "risley"}}},
         {"detector", {{"rows", 18}, {"columns", 20}}},
         {"laser", {{"pulse_rate_hz", 20000}, {"scan_time_s", 2}}},
         {"trajectory", {{"position_m", {0, 0, 300}}}},
         {"noise", {{"range_sigma_m", 0.02}}}}}},
      {{"tool", "regrid"}, {"config", {{"resolution_m", 0.05}}}}};
  EXPECT_EQ(title_of(steps),
            "mars.tif with fractal relief, golombek rocks and cone features, risley scanner");
  EXPECT_EQ(origin_of(steps),
            "80 x 80 m of terrain at 5 cm; 2 s of pulses of 20 x 18 pixels at 20 kHz from 300 m, range noise "
            "of 2 cm (1 "
            "sigma); bins of 5 cm");
}

TEST(Heading, SaysWhatTheStepsSay) {
  EXPECT_EQ(title_of(Json::array({terrain({{"base", {{"type", "plane"}}}})})), "plane");
  EXPECT_EQ(title_of(Json::array()), "DEM evaluation");
  EXPECT_EQ(origin_of(Json::array()), "");
}

TEST(Heading, IgnoresStepsOfAnotherStructure) {
  for (const Json& step :
       {Json(7), Json("x"), Json{{"tool", "terrain-gen"}, {"config", 3}},
        Json{{"tool", "terrain-gen"}, {"config", {{"base", {1, nullptr}}, {"patterns", "p"}}}},
        Json{{"tool", "scan-sim"}, {"config", {{"detector", {{"rows", "many"}}}}}}}) {
    EXPECT_EQ(title_of(Json::array({step})), "DEM evaluation");
    EXPECT_EQ(origin_of(Json::array({step})), "");
  }
}

}  // namespace
}  // namespace landfall::html_report
