// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/hazard_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/core/parallel.h"

namespace landfall::html_report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const PhaseRunner kAtOnce = [](const std::string& /*name*/, const auto& part) { part({}); };

/// Level terrain of 41 x 41 bins with a rock at (0.5, 0.5) m, and a truth that has another one at (-1, -1) m.
struct Case {
  Case() {
    parameters.lander = {.leg_radius_m = 0.3, .pad_diameter_m = 0.1, .body_radius_m = 0.3};
    parameters.region_radius_m = 1.8;
    parameters.touchdown_sigma_m = 0;
    parameters.sites.separation_m = 0.5;
    input.z.at(spec.bin_of(0.5, 0.5)) = 0.5;
    input.z_true = input.z;
    input.z_true->at(spec.bin_of(-1, -1)) = 0.5;
  }

  GridSpec spec = GridSpec::centered(2, 0.1);
  HazardInput input{Grid<double>(spec), std::nullopt, BinMask(spec), std::nullopt};
  HazardParameters parameters;
  Provenance provenance{.tool = "hazard-map", .config = {{"method", "contact"}}, .inputs = {{"dem", "f00"}}};

  [[nodiscard]] ReportData data(std::int64_t max_cells = kMaxCells) const {
    HazardInput judged = input;
    const HazardMap map = map_hazards(judged, parameters, kAtOnce);
    return hazard_data({judged, parameters, map}, "z_est", max_cells);
  }
  [[nodiscard]] std::string page(const std::string& title = {}) const {
    HazardInput judged = input;
    const HazardMap map = map_hazards(judged, parameters, kAtOnce);
    return hazard_page({judged, parameters, map}, provenance, title);
  }
};

std::vector<std::string> names_of(const ReportData& data) {
  std::vector<std::string> names;
  for (const auto& layer : data.values["layers"]) names.push_back(layer["name"]);
  return names;
}

const nlohmann::ordered_json& named(const ReportData& data, const std::string& name) {
  const auto& layers = data.values["layers"];
  return *std::ranges::find_if(layers, [&](const auto& layer) { return layer["name"] == name; });
}

TEST(HazardData, HasTheLayersThatTheMapHas) {
  Case c;
  EXPECT_THAT(names_of(c.data()),
              ElementsAre("safe", "outcome", "p_touchdown", "cost", "distance_to_hazard", "slope",
                          "roughness", "slope_true", "roughness_true", "z_est", "z_true"));
  c.input.z_true.reset();
  c.input.z_sigma = Grid<double>(c.spec, 0.01);
  const ReportData data = c.data();
  EXPECT_THAT(names_of(data), ElementsAre("safe", "p_safe", "p_touchdown", "cost", "distance_to_hazard",
                                          "slope", "roughness", "z_est"));
  EXPECT_TRUE(data.values["score"].is_null());
}

TEST(HazardData, CountsEachClassOnce) {
  const Case c;
  const ReportData data = c.data();
  for (const char* const name : {"safe", "outcome"}) {
    std::int64_t count = 0;
    std::int64_t bits = 0;
    for (const auto& part : named(data, name)["flags"]) {
      count += part["count"].get<std::int64_t>();
      bits += part["bits"].get<std::int64_t>();
    }
    EXPECT_EQ(count, data.values["places"]) << name;
    EXPECT_EQ(bits, std::string_view(name) == "safe" ? 7 : 31);
  }
  const auto& missed = named(data, "outcome")["flags"][0];
  EXPECT_EQ(missed["text"], "missed hazard");
  EXPECT_EQ(missed["count"], 29 + 8);  // the disc of 3 bins about the rock, and pads at (3, 1)
  EXPECT_EQ(missed["is_mark"], true);
}

// The first class among the places in a block is drawn; the worst for a lander, as in the pictures of --view.
TEST(HazardData, ClassesAreFromTheWorstToTheBest) {
  const ReportData data = Case().data();
  const auto texts = [&](const char* name) {
    std::vector<std::string> found;
    for (const auto& part : named(data, name)["flags"]) found.push_back(part["text"]);
    return found;
  };
  EXPECT_THAT(texts("safe"), ElementsAre("hazard", "unknown", "safe"));
  EXPECT_THAT(texts("outcome"),
              ElementsAre("missed hazard", "hazard found", "false alarm", "unknown", "safe found"));
  EXPECT_EQ(named(data, "outcome")["flags"][1]["is_mark"], false);
  EXPECT_EQ(named(data, "outcome")["flags"][2]["is_mark"], true);
}

// A single wrong place of 41 x 41 bins stays in a map of 7 x 7 blocks.
TEST(HazardData, ABlockHasTheClassesOfAllItsBins) {
  Case c;
  c.input.z_true = c.input.z;
  HazardMap map = map_hazards(c.input, c.parameters, kAtOnce);
  map.truth->outcome.at(c.spec.bin_of(0, 0)) = static_cast<std::int8_t>(HazardOutcome::missed_hazard);
  const ReportData data = hazard_data({c.input, c.parameters, map}, "z_est", 7);
  EXPECT_EQ(data.values["grid"]["factor"], 6);
  const auto& outcome = named(data, "outcome");
  EXPECT_EQ(outcome["rule"], "any_bit");
  EXPECT_EQ(outcome["step"], 1);
  EXPECT_GE(outcome["high"], 4 + 2);
}

TEST(HazardData, ASiteHasItsSurroundingsAndPoses) {
  const Case c;
  const ReportData data = c.data();
  const auto& site = data.values["sites"][0];
  EXPECT_EQ(site["x_m"], 0);
  EXPECT_EQ(site["crop"]["rows"], 2 * 7 + 1);  // 1.15 x 0.35 m and two bins on each side
  EXPECT_DOUBLE_EQ(site["crop"]["x_m"].get<double>(), -0.7);
  EXPECT_EQ(site["poses"]["steepest"]["pads"].size(), 4U);
  EXPECT_EQ(site["poses"]["roughest"]["roughness_m"], 0);
}

TEST(HazardData, OnlyTheBestSitesHavePoses) {
  Case c;
  c.parameters.sites.count = 15;
  c.parameters.sites.separation_m = 0.1;
  const ReportData data = c.data();
  EXPECT_EQ(data.values["sites"].size(), 15U);
  EXPECT_TRUE(data.values["sites"][9].contains("poses"));
  EXPECT_FALSE(data.values["sites"][10].contains("poses"));
}

TEST(HazardPage, AsksForNothingElse) {
  const std::string page = Case().page();
  for (const char* const sign : {"src=", "@import", "url(h", "href=\"http", "fetch(", "XMLHttpRequest"})
    EXPECT_THAT(page, Not(HasSubstr(sign)));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
}

TEST(HazardPage, EscapesWhatComesFromFilesAndTheUser) {
  const std::string bad = "</script><script>alert(1)</script>&\"'@style@";
  Case c;
  c.provenance.config = {{"method", bad}};
  c.provenance.inputs = {{"dem", bad}};
  c.provenance.chain = {{{"tool", bad}, {"file_id", bad}, {"config", {{bad, bad}}}}, 7, "x"};
  const std::string page = c.page(bad);
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(
      page,
      HasSubstr("<h1>&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;@style@</h1>"));
}

TEST(HazardPage, HasATitleWithoutSteps) { EXPECT_THAT(Case().page(), HasSubstr("<h1>Landing sites</h1>")); }

TEST(HazardPage, TheBannerIsTheVerdictOfRequireSafe) {
  Case c;
  EXPECT_THAT(c.page(), HasSubstr("<div class=\"banner pass\" id=\"verdict\">the best site (0, 0) m; no "
                                  "probability: the map has no 1-sigma layer</div>"));
  Case with_sigma;
  with_sigma.input.z_sigma = Grid<double>(c.spec, 0.0);
  EXPECT_THAT(with_sigma.page(), HasSubstr("<div class=\"banner pass\" id=\"verdict\">the best site (0, 0) m "
                                           "has a p_touchdown of at least 0.9957</div>"));
  c.parameters.touchdown_sigma_m = 0.5;
  EXPECT_THAT(c.page(), HasSubstr("<div class=\"banner fail\" id=\"verdict\">no site has a p_touchdown of "
                                  "0.99 or more: the best site ("));
  c.parameters.limits.slope_deg = 0;
  c.parameters.limits.roughness_m = 0;
  for (std::size_t i = 0; i < c.spec.size(); ++i) c.input.z.values()[i] = (i % 7 == 0) ? 1 : 0;
  EXPECT_THAT(c.page(), HasSubstr("<div class=\"banner fail\" id=\"verdict\">no landing site"));
}

TEST(HazardPage, HasTheSameBytesForAnyNumberOfThreads) {
  const auto with = [](std::size_t threads) {
    const ThreadLimit limit(threads);
    return Case().page();
  };
  EXPECT_EQ(with(1), with(4));
}

}  // namespace
}  // namespace landfall::html_report
