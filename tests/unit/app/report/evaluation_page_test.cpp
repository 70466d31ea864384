// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "app/report/cloud_page.h"
#include "app/report/escape.h"
#include "app/report/evaluation_page.h"
#include "app/report/heading.h"
#include "base/core/parallel.h"

namespace landfall::html_report {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string page_of(const DemLayers& dem, const nlohmann::json& steps, const std::string& title = "") {
  EvaluationParameters parameters;
  parameters.region_radius_m = 1;
  ReportLayers layers(dem.z_est.spec(), parameters);
  layers.take(dem);
  const Evaluation evaluation = evaluate(dem, parameters, {&layers});
  return report_page({parameters, evaluation, layers, {}, steps, title});
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
  const nlohmann::json steps = {{{"tool", "dem-eval"}}};
  const std::string page = page_of(dem_without_truth(), steps, "Ice & <b>rocks</b> @style@");
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

TEST(WideCodes, WholeNumbersAreExact) {
  const WideCodes codes = wide_codes(std::array{70000.0, 12.0, std::numeric_limits<double>::quiet_NaN()}, 10);
  EXPECT_EQ(codes.step, 1);
  EXPECT_EQ(codes.offset, 12);
  EXPECT_THAT(codes.codes, ElementsAre(69988, 0, kNoWideCode));
}

TEST(WideCodes, OutliersDoNotCoarsenTheOthers) {
  std::vector<double> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.001 * static_cast<double>(i);
  const double step = wide_codes(values, 500).step;
  values.front() = -1e6;
  EXPECT_EQ(wide_codes(values, 500).step, step);
}

// docs/user/landfall-export.md: 25 MB. Noise in all columns is more than any scan has, whose pulses are in
// order.
TEST(CloudData, AMillionPointsOfAllColumnsFitTheLimitOfThePage) {
  constexpr std::size_t kPoints = 1'000'000;
  std::mt19937 random(1);
  const auto noise = [&](double low, double high) {
    std::vector<double> values(kPoints);
    for (double& value : values) value = low + (high - low) * static_cast<double>(random()) / 4294967295.0;
    return values;
  };
  CloudContent content;
  for (const char* const name :
       {"x_est", "y_est", "z_est", "x_true", "y_true", "z_true", "range_measured", "range_true"})
    content.columns[name] = noise(0, 100);
  content.columns["intensity"] = noise(0, 4000);
  content.columns["return_number"] = std::vector<double>(kPoints, 1);
  content.columns["status"] = std::vector<double>(kPoints, 0);
  for (const char* const name : {"t", "pulse", "pixel"}) content.columns[name].resize(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double pulse = static_cast<double>(13 * i + random() % 13);
    content.columns["pulse"][i] = pulse;
    content.columns["t"][i] = pulse / 1e6;
    content.columns["pixel"][i] = static_cast<double>(random() % 65536);
    if (random() % 3 == 0) content.columns["return_number"][i] = static_cast<double>(1 + random() % 4);
  }
  std::size_t bytes = 0;
  for (const auto& [name, packed] : cloud_data(content).packed) bytes += packed.size();
  EXPECT_LT(bytes, 25'000'000U - 300'000U);  // the page itself has 0.3 MB at most
  EXPECT_GT(bytes, 10'000'000U);
}

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

std::string base64_of(const std::string& text) { return base64(std::as_bytes(std::span(text))); }

TEST(HtmlText, TurnsMarkupIntoReferences) {
  EXPECT_EQ(html_text("<b class=\"a\">R&D's</b>"), "&lt;b class=&quot;a&quot;&gt;R&amp;D&#39;s&lt;/b&gt;");
  EXPECT_EQ(html_text("plain"), "plain");
}

TEST(HtmlText, ShowsWhatWouldHideOrReverse) {
  EXPECT_EQ(html_text("a\x1b[31m\nb\u202ec"), "a\\u001b[31m\nb\\u202ec");
}

TEST(ScriptJson, ShowsWhatWouldHideOrReverse) {
  const nlohmann::ordered_json hostile = {{"key\u202e", {"a\x07", 1.5, nullptr, {{"b", "\u00e9\u200b"}}}}};
  const nlohmann::ordered_json shown = {{"key\\u202e", {"a\\u0007", 1.5, nullptr, {{"b", "\u00e9\\u200b"}}}}};
  EXPECT_EQ(nlohmann::ordered_json::parse(script_json(hostile)), shown);
}

TEST(ScriptJson, CannotEndItsElement) {
  const nlohmann::ordered_json value = {{"path", "</script><!--"}};
  const std::string text = script_json(value);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::ordered_json::parse(text), value);
}

TEST(ScriptJson, HasNullForNumbersThatAreNotFiniteAndReplacesBrokenText) {
  EXPECT_EQ(script_json({{"a", std::nan("")}}), "{\"a\":null}");
  EXPECT_EQ(script_json({{"a", "\xff"}}), "{\"a\":\"\\\\xff\"}");
}

// RFC 4648, section 10.
TEST(Base64, IsTheStandardsExamples) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace landfall::html_report
