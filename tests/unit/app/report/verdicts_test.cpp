// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/verdicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "judged.h"

namespace landfall::html_report {
namespace {

using testing::HasSubstr;

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

}  // namespace
}  // namespace landfall::html_report
