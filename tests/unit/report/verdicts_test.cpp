// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/verdicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace landfall::html_report {
namespace {

using testing::HasSubstr;

Metrics metrics_of() {
  Metrics metrics;
  metrics.requirements = {.coverage = {0.012, 0.01, false},
                          .hole_size = {1, 10, true},
                          .hole_distance = {1, 1, true},
                          .relative_elevation = {0, 0, true},
                          .relative_horizontal = {3, 0, false},
                          .absolute_horizontal = {0.97, 0.95, true}};
  metrics.pass = false;
  return metrics;
}

TEST(VerdictTable, HasValueLimitAndMargin) {
  const std::string table = verdict_table_html(metrics_of());
  EXPECT_THAT(table,
              HasSubstr("<td class=\"number\">1.2 %</td><td class=\"number\">at most 1 %</td>"
                        "<td class=\"number\">\u22120.2 %</td><td><span class=\"verdict fail\">FAIL</span>"));
  EXPECT_THAT(table,
              HasSubstr("<td class=\"number\">1 bin</td><td class=\"number\">at most 10 bins</td>"
                        "<td class=\"number\">9 bins</td><td><span class=\"verdict pass\">pass</span>"));
  EXPECT_THAT(table, HasSubstr("<td class=\"number\">97 %</td><td class=\"number\">at least 95 %</td>"
                               "<td class=\"number\">2 %</td>"));
  EXPECT_THAT(table, HasSubstr("<td class=\"number\">3</td><td class=\"number\">at most 0</td>"
                               "<td class=\"number\">\u22123</td>"));
}

TEST(VerdictTable, LeavesOpenWhatIsNotJudged) {
  Metrics metrics = metrics_of();
  metrics.requirements.relative_elevation = {std::nullopt, 0, std::nullopt};
  EXPECT_THAT(
      verdict_table_html(metrics),
      HasSubstr("<td class=\"number\">\u2013</td><td class=\"number\">at most 0</td>"
                "<td class=\"number\">\u2013</td><td><span class=\"verdict unjudged\">not judged</span>"));
}

TEST(VerdictBanner, CountsTheMissedOnes) {
  EXPECT_THAT(verdict_banner_html(metrics_of()), HasSubstr("FAIL: 2 of 6 requirements missed<"));
  Metrics metrics = metrics_of();
  for (Requirement* const r : {&metrics.requirements.coverage, &metrics.requirements.relative_horizontal})
    r->pass = true;
  metrics.pass = true;
  EXPECT_THAT(verdict_banner_html(metrics), HasSubstr("class=\"banner pass\" id=\"verdict\">pass: all 6"));
  metrics.requirements.relative_elevation.pass = std::nullopt;
  metrics.pass = std::nullopt;
  EXPECT_THAT(verdict_banner_html(metrics), HasSubstr("class=\"banner unjudged\""));
  metrics.requirements.coverage.pass = false;
  EXPECT_THAT(verdict_banner_html(metrics), HasSubstr("FAIL: 1 of 6 requirements missed, 1 of 6 not judged"));
}

}  // namespace
}  // namespace landfall::html_report
