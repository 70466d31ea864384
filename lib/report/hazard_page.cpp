// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/hazard_page.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/number_text.h"
#include "report/escape.h"
#include "report/heading.h"
#include "report/page_parts.h"
#include "report/verdicts.h"

namespace landfall::html_report {
namespace {

std::string share(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? "\u2013" : percent_text(static_cast<double>(part) / static_cast<double>(whole));
}

std::string row(const std::string& name, std::int64_t count, std::int64_t all, const std::string& note) {
  return "<tr><th scope=\"row\">" + name + "</th><td class=\"number\">" + grouped(count) +
         "</td><td class=\"number\">" + share(count, all) + "</td><td>" + note + "</td></tr>\n";
}

std::string table(const std::string& id, const std::string& heading, const std::string& rows) {
  return "<table id=\"" + id + "\"><thead><tr><th>" + heading +
         "</th><th class=\"number\">places</th><th class=\"number\">of the region</th><th></th></tr></thead>"
         "<tbody>\n" +
         rows + "</tbody></table>\n";
}

std::string places_html(const PlaceCounts& counts) {
  return table("places", "on the map",
               row("safe", counts.safe, counts.all(), "") + row("hazard", counts.hazard, counts.all(), "") +
                   row("unknown", counts.unknown, counts.all(),
                       "a part of the lander lies on a bin without an elevation, or beyond the map"));
}

std::string outcomes_html(const HazardScore::Counts& n, std::int64_t all) {
  const std::int64_t hazards = n.safe_hazard + n.hazard_hazard;
  const std::int64_t safe = n.safe_safe + n.hazard_safe;
  return table("outcomes", "compared with the truth",
               row("missed hazard", n.safe_hazard, all,
                   share(n.safe_hazard, hazards) + " of the " + grouped(hazards) + " true hazards") +
                   row("false alarm", n.hazard_safe, all,
                       share(n.hazard_safe, safe) + " of the " + grouped(safe) + " truly safe places") +
                   row("hazard found", n.hazard_hazard, all, "") + row("safe found", n.safe_safe, all, "") +
                   row("unknown", n.unknown, all, "on the map or on the true ground"));
}

std::string metres(double value) { return number_text(value) + " m"; }

std::string lander_text(const HazardParameters& parameters, const std::string& method) {
  const Lander& lander = parameters.lander;
  const std::string legs = parameters.method == HazardMethod::contact
                               ? std::to_string(lander.legs) + " legs at " + metres(lander.leg_radius_m) +
                                     " from the centre, pads of " + metres(lander.pad_diameter_m) + ", "
                               : "";
  return "Lander: " + legs + "body of " + metres(2 * lander.body_radius_m) + "; method " + method +
         ". A place is safe if its slope is at most " + number_text(parameters.limits.slope_deg) +
         " deg and its roughness at most " + metres(parameters.limits.roughness_m) +
         ". Places are the bins " + region_text(parameters) + "; a touchdown is off its target by " +
         metres(parameters.touchdown_sigma_m) + " (1 sigma along x and y).";
}

std::string probability_text(double p) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f", p);
  return text.data();
}

std::string place_text(const LandingSite& site, bool has_probability) {
  return "(" + short_number(site.x_m) + ", " + short_number(site.y_m) + ") m" +
         (has_probability ? " has a p_touchdown of " + probability_text(static_cast<double>(site.p_touchdown))
                          : std::string("; ") + kNoProbability);
}

/// Whether --require-safe accepts the map.
std::string banner_html(const HazardMap& map, const OwnVerdicts& own, double min_p) {
  const std::vector<LandingSite>& sites = map.sites;
  const auto best = std::ranges::max_element(sites, {}, &LandingSite::p_touchdown);
  const bool has_site = best != sites.end() && best->p_touchdown >= min_p;
  const bool accepted = has_site && all_pass(own);
  std::string text = "no landing site: no safe place within reach";
  if (!sites.empty())
    text = (has_site ? "" : "no site has a p_touchdown of " + number_text(min_p) + " or more: ") +
           std::string("the best site ") + place_text(sites.front(), map.p_safe.has_value());
  if (!all_pass(own)) text += "; " + own_missed_text(own);
  return std::string("<div class=\"banner ") + (accepted ? "pass" : "fail") + "\" id=\"verdict\">" + text +
         "</div>";
}

}  // namespace

std::string hazard_page(const HazardReport& content, const Provenance& provenance, const std::string& title) {
  nlohmann::json steps = provenance.chain;
  steps.push_back(provenance.as_step());
  const std::string kind = provenance.inputs.empty() ? "dem" : provenance.inputs.front().role;
  const HazardMap& map = content.map;
  const PlaceCounts counts = count_places(map.safe, map.region);
  std::string tables = places_html(counts);
  if (map.truth) tables += outcomes_html(map.truth->score.counts, counts.all());
  const OwnVerdicts own = own_verdicts(map, content.parameters);
  tables += own_table_html(own);
  return page_html("hazards.html",
                   {{"title", html_text(title.empty() ? title_of(steps, "Landing sites") : title)},
                    {"subtitle", subtitle_html(steps, "hazard map", kind == "dem" ? "DEM" : "terrain", kind)},
                    {"banner", banner_html(map, own, content.parameters.sites.min_p)},
                    {"places", tables},
                    {"lander", lander_text(content.parameters, text_of(provenance.config, "method"))},
                    {"provenance", provenance_html(steps)},
                    {"data", data_html(hazard_data(content, kind == "dem" ? "z_est" : "z"))}});
}

}  // namespace landfall::html_report
