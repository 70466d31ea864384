// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "base/dictionary/requirement.h"
#include "chain/evaluation/judge/verdict.h"
#include "chain/evaluation/metrics.h"
#include "chain/evaluation/verdict_text.h"

namespace landfall {
namespace {

Metrics measured() {
  Metrics metrics;
  metrics.statistics.z.le90_m = 0.25;
  metrics.coverage.hole_count = 3;
  metrics.coverage.max_distance_bins = std::numeric_limits<double>::infinity();
  for (RequirementVerdict& verdict : metrics.requirements.all) verdict.pass = true;
  return metrics;
}

Metrics judged(const std::vector<Requirement>& requirements) {
  Metrics metrics = measured();
  judge_own_requirements(metrics, requirements);
  return metrics;
}

TEST(OwnRequirements, EqualToTheLimitPasses) {
  const auto pass = [](double limit, bool at_least) {
    return judged({{"x", "statistics.z.le90_m", limit, at_least}}).pass;
  };
  EXPECT_EQ(pass(0.25, false), true);
  EXPECT_EQ(pass(0.25, true), true);
  EXPECT_EQ(pass(std::nextafter(0.25, 0), false), false);
  EXPECT_EQ(pass(std::nextafter(0.25, 1), true), false);
}

TEST(OwnRequirements, CountsAreNumbers) {
  const Metrics metrics = judged({{"x", "coverage.hole_count", 3, false}});
  EXPECT_EQ(metrics.own_requirements.all.at(0).value, 3.0);
  EXPECT_EQ(metrics.pass, true);
}

// metrics.json has null for all of these.
TEST(OwnRequirements, UnknownNumbersAreNotMet) {
  for (const char* const metric : {"coverage.max_distance_bins", "statistics.x.le90_m",
                                   "accuracy.relative.z.max_m", "uncertainty.absolute.std"}) {
    const Metrics metrics = judged({{"x", metric, 1e9, false}});
    EXPECT_EQ(metrics.own_requirements.all.at(0).value, std::nullopt) << metric;
    EXPECT_EQ(metrics.pass, false) << metric;
  }
}

TEST(OwnRequirements, AMissedOneOutweighsOneThatIsNotJudged) {
  Metrics metrics = measured();
  metrics.requirements["relative_elevation"].pass.reset();
  judge_own_requirements(metrics, {{"x", "coverage.hole_count", 3, false}});
  EXPECT_EQ(metrics.pass, std::nullopt);
  EXPECT_STREQ(overall_verdict(metrics), "not judged");
  judge_own_requirements(metrics, {{"x", "coverage.hole_count", 2, false}});
  EXPECT_EQ(metrics.pass, false);
  EXPECT_STREQ(overall_verdict(metrics), "FAIL");
}

TEST(OwnRequirements, JudgedAgainTheyReplaceTheOldOnes) {
  Metrics metrics = judged({{"x", "coverage.hole_count", 2, false}});
  judge_own_requirements(metrics, {{"y", "coverage.hole_count", 3, false}});
  EXPECT_EQ(metrics.own_requirements.all.size(), 1u);
  EXPECT_EQ(metrics.pass, true);
}

TEST(OwnRequirements, NumbersOfMetrics) {
  const std::vector<ResultField> fields = metrics_fields();
  const auto is_number = [&](const std::string& path) {
    const auto found = std::ranges::find(fields, path, &ResultField::path);
    return found != fields.end() && found->is_number;
  };
  for (const char* const path :
       {"statistics.z_corrected.le90_m", "uncertainty.relative.std", "region.bin_count",
        "accuracy.absolute.z_corrected.p95_m", "requirements.coverage.value"})
    EXPECT_TRUE(is_number(path)) << path;
  for (const char* const path :
       {"pass", "region.shape", "coverage.hole_size_histogram.count", "requirements.coverage.pass", "x"})
    EXPECT_FALSE(is_number(path)) << path;
  for (const ResultField& decisive : decisive_fields())  // the paths of verdicts are those of metrics
    EXPECT_NE(std::ranges::find(fields, decisive.path, &ResultField::path), fields.end()) << decisive.path;
}

// A new row whose words lead nowhere fails here.
TEST(Dictionary, WordsOfRequirementsLeadToNumbersAndLimits) {
  const auto has = [](const std::vector<ResultField>& fields, const std::string& path) {
    const auto found = std::ranges::find(fields, path, &ResultField::path);
    return found != fields.end() && found->is_number;
  };
  const auto parts = [](std::string text, const std::string& separator) {
    std::vector<std::string> found;
    for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator)) {
      found.push_back(text.substr(0, end));
      text = text.substr(end + separator.size());
    }
    found.push_back(text);
    return found;
  };
  for (const dictionary::Requirement& words : dictionary::kRequirements) {
    for (const std::string& metric : parts(words.value, " + ")) {
      EXPECT_TRUE(has(metrics_fields(), metric)) << metric;
      EXPECT_TRUE(has(decisive_fields(), metric)) << metric;
    }
    for (const std::string& metric : parts(words.worst, " "))
      EXPECT_TRUE(has(metrics_fields(), metric)) << metric;
    EXPECT_TRUE(limit_of_key({}, words.worst_limit).has_value()) << words.name;
    EXPECT_EQ(limit_of_key({}, words.limit).has_value(), *words.limit != '\0') << words.name;
    for (const char axis : std::string(words.footprints))
      EXPECT_THAT("xyz", testing::HasSubstr(std::string(1, axis)));
    for (const std::string& part : parts(words.text, "{")) {
      const std::string word = part.substr(0, part.find('}'));
      const bool is_path = word.find('.') != std::string::npos && part.find('}') != std::string::npos;
      EXPECT_TRUE(!is_path || has(metrics_fields(), word)) << word;
    }
  }
}

TEST(OwnRequirements, Texts) {
  const auto texts = own_texts(judged({{"le90", "statistics.z.le90_m", 0.2, false},
                                       {"valid", "statistics.valid_frac", 0.5, true},
                                       {"bins", "coverage.largest_hole_bins", 1, false},
                                       {"count", "coverage.hole_count", 3, false},
                                       {"x", "statistics.x.le90_m", 1, false}})
                                   .own_requirements);
  const auto is = [&](std::size_t i, const std::string& value, const std::string& limit,
                      const std::string& verdict) {
    EXPECT_EQ(texts.at(i).value, value);
    EXPECT_EQ(texts.at(i).limit, limit);
    EXPECT_EQ(texts.at(i).verdict, verdict);
  };
  is(0, "statistics.z.le90_m 25 cm", "20 cm", "FAIL");
  is(1, "statistics.valid_frac 0 %", ">= 50 %", "FAIL");
  is(2, "coverage.largest_hole_bins 0 bins", "1 bin", "pass");
  is(3, "coverage.hole_count 3", "3", "pass");
  is(4, "statistics.x.le90_m: no value", "100 cm", "FAIL");
  EXPECT_EQ(verdict_texts(judged({{"le90", "statistics.z.le90_m", 0.2, false}}), {}).at(6).name, "le90");
}

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
