// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/verdict_text.h"

#include <gtest/gtest.h>

#include <string>

namespace landfall {
namespace {

/// 87,348 of 785,321 footprints miss the limit of rel_z; all else passes.
Metrics tutorial() {
  Metrics m;
  m.region.bin_count = 785'321;
  m.coverage.invalid_count = 3;
  m.coverage.invalid_frac = 3.0 / 785'321;
  m.coverage.largest_hole_bins = 1;
  m.coverage.max_distance_bins = 1;
  AccuracyMetrics& a = m.accuracy.emplace();
  a.footprint_bins = 35;
  a.absolute.horizontal = {.p95_m = 0.00361, .within_limit_frac = 1};
  a.relative.x = {.p95_m = 0.018, .max_m = 0.0202, .violation_count = 0};
  a.relative.y = {.p95_m = 0.018, .max_m = 0.02, .violation_count = 0};
  a.relative.z = {.p95_m = 0.05104, .max_m = 0.05791, .violation_count = 87'348};
  m.requirements = judge(m, {});
  return m;
}

TEST(VerdictText, CountsHaveTheirDenominatorAndLengthsTheirLimit) {
  const auto texts = verdict_texts(tutorial(), {});
  const auto is = [&](std::size_t i, const std::string& value, const std::string& limit,
                      const std::string& verdict) {
    EXPECT_EQ(texts[i].name, std::string(dictionary::kRequirements[i].name));
    EXPECT_EQ(texts[i].value, value);
    EXPECT_EQ(texts[i].limit, limit);
    EXPECT_EQ(texts[i].verdict, verdict);
  };
  is(0, "3 of 785,321 bins invalid, 0.000382 %", "1 %", "pass");
  is(1, "largest hole 1 bin", "10 bins", "pass");
  is(2, "to the nearest valid bin 1 bin", "1 bin", "pass");
  is(3, "87,348 of 785,321, 11.1 %, worst 5.79 cm", "5 cm", "FAIL");
  is(4, "0 of 1,570,642, 0 %, worst 2.02 cm", "5 cm", "pass");
  is(5, "100 % within 100 cm, 95th pct 0.361 cm", ">= 95 %", "pass");
}

TEST(VerdictText, AMissedRequirementOutweighsOneThatIsNotJudged) {
  Metrics m = tutorial();
  EXPECT_EQ(overall_verdict(m), std::string("FAIL"));
  m.accuracy.reset();
  m.requirements = judge(m, {});
  EXPECT_EQ(overall_verdict(m), std::string("not judged"));
  EXPECT_EQ(verdict_texts(m, {})[3].value, "no truth to compare with");
  EXPECT_EQ(verdict_texts(m, {})[3].verdict, std::string("not judged"));
  m.coverage.invalid_frac = 0.5;
  m.requirements = judge(m, {});
  EXPECT_EQ(overall_verdict(m), std::string("FAIL"));
}

TEST(VerdictText, AllPass) {
  Metrics m = tutorial();
  m.accuracy->relative.z.violation_count = 0;
  m.requirements = judge(m, {});
  EXPECT_EQ(overall_verdict(m), std::string("pass"));
}

TEST(VerdictText, TooFewBins) {
  Metrics m = tutorial();
  EXPECT_EQ(missing_text(m), "");
  m.accuracy->footprint_bins = 3;
  m.accuracy->relative = {};
  m.requirements = judge(m, {});
  for (const std::size_t i : {3U, 4U}) {
    EXPECT_EQ(verdict_texts(m, {})[i].value, "footprint of 3 x 3 bins");
    EXPECT_EQ(verdict_texts(m, {})[i].verdict, std::string("not judged"));
  }
  EXPECT_EQ(overall_verdict(m), std::string("not judged"));
  EXPECT_EQ(missing_text(m), "the footprint has fewer than 5 x 5 bins");
  m.requirements["absolute_horizontal"].pass.reset();
  EXPECT_EQ(missing_text(m), "the footprint has fewer than 5 x 5 bins, and the DEM has no true positions");
  for (RequirementVerdict& verdict : m.requirements.all) verdict.reason.reset();
  for (const char* const name : {"relative_elevation", "relative_horizontal"})
    m.requirements[name].pass = true;
  EXPECT_EQ(missing_text(m), "the DEM has no true positions");
  m.accuracy.reset();
  EXPECT_EQ(missing_text(m), "the DEM has no truth");
}

TEST(VerdictText, Assumptions) {
  EXPECT_EQ(
      assumption_texts({35, 0.05, 3.0, 0.1234}),
      (std::vector<std::string>{"footprint of 35 x 35 bins", "truth nodes every 0.05 m",
                                "3 returns per bin (median)", "12.3 % of the bins with a single return"}));
  EXPECT_EQ(assumption_texts({3}), std::vector<std::string>{"footprint of 3 x 3 bins"});
}

TEST(VerdictText, NoFootprintToJudge) {
  Metrics m = tutorial();
  m.accuracy->relative.z = {};
  m.requirements = judge(m, {});
  EXPECT_EQ(verdict_texts(m, {})[3].value, "no footprint to judge");
  EXPECT_EQ(verdict_texts(m, {})[3].verdict, std::string("FAIL"));
}

}  // namespace
}  // namespace landfall
