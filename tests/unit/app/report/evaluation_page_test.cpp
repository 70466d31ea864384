// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/evaluation_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/core/parallel.h"

namespace landfall::html_report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string page_of(const DemLayers& dem, const nlohmann::json& steps) {
  EvaluationParameters parameters;
  parameters.region_radius_m = 1;
  ReportLayers layers(dem.z_est.spec(), parameters);
  layers.take(dem);
  const Evaluation evaluation = evaluate(dem, parameters, {&layers});
  return report_page({parameters, evaluation, layers, {}, steps});
}

std::string page_of(const DemLayers& dem) {
  return page_of(dem, {{{"tool", "dem-eval"}, {"version", "1"}, {"config", nlohmann::json::object()}}});
}

DemLayers dem_without_truth(double elevation_m = 1) {
  return {.z_est = Grid<double>(GridSpec::centered(2, 0.1), elevation_m), .truth = std::nullopt};
}

TEST(ReportPage, AsksForNothingElse) {
  const std::string page = page_of(dem_without_truth());
  for (const char* const sign : {"src=", "@import", "url(h", "href=\"http", "fetch(", "XMLHttpRequest"})
    EXPECT_THAT(page, Not(HasSubstr(sign)));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
}

TEST(ReportPage, EscapesWhatComesFromFiles) {
  const std::string bad = "</script><script>alert(1)</script>&\"'@style@";
  const std::string page = page_of(
      dem_without_truth(), {{{"tool", bad}, {"version", bad}, {"file_id", bad}, {"config", {{bad, bad}}}},
                            {{"tool", "dem-eval"}, {"inputs", {{{"role", "dem"}, {"file_id", bad}}}}}});
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;@style@"));
}

TEST(ReportPage, StandsStepsOfAnotherShape) {
  for (const nlohmann::json& step : {nlohmann::json(7), nlohmann::json("x"),
                                     nlohmann::json{{"tool", 1}, {"inputs", 3}, {"config", "\xff"}},
                                     nlohmann::json{{"inputs", {nullptr, 1, {{"role", nullptr}}}}}})
    EXPECT_THAT(page_of(dem_without_truth(), {step, step}), HasSubstr("</html>"));
}

TEST(ReportPage, StandsADemWithoutAnyElevation) {
  EXPECT_THAT(page_of(dem_without_truth(std::nan(""))), HasSubstr("FAIL: 3 of 6 requirements missed"));
}

TEST(ReportPage, HasTheTitleOfTheUserOrOfTheSteps) {
  EXPECT_THAT(page_of(dem_without_truth()), HasSubstr("<h1>DEM evaluation</h1>"));
  const DemLayers dem = dem_without_truth();
  EvaluationParameters parameters;
  parameters.region_radius_m = 1;
  ReportLayers layers(dem.z_est.spec(), parameters);
  layers.take(dem);
  const Evaluation evaluation = evaluate(dem, parameters, {&layers});
  const nlohmann::json steps = {{{"tool", "dem-eval"}}};
  const std::string page =
      report_page({parameters, evaluation, layers, {}, steps, "Ice & <b>rocks</b> @style@"});
  for (const char* const tag : {"h1", "title"})
    EXPECT_THAT(page, HasSubstr(std::string("<") + tag + ">Ice &amp; &lt;b&gt;rocks&lt;/b&gt; @style@</" +
                                tag + ">"));
}

TEST(ReportPage, HasTheSameBytesForAnyNumberOfThreads) {
  const auto with = [](std::size_t threads) {
    const ThreadLimit limit(threads);
    return page_of(dem_without_truth());
  };
  EXPECT_EQ(with(1), with(4));
}

}  // namespace
}  // namespace landfall::html_report
