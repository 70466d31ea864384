// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/draws_page.h"

#include <array>
#include <cstdio>

#include "base/number_text.h"
#include "report/escape.h"
#include "report/heading.h"
#include "report/page_parts.h"

namespace landfall::html_report {
namespace {

using Json = nlohmann::ordered_json;

/// Probabilities near 1 need their last digits.
std::string p_text(const Json& p) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f", p.get<double>());
  return text.data();
}

std::string number_cell(const std::string& text) { return "<td class=\"number\">" + text + "</td>"; }

std::string rate_row_html(const std::string& name, const Json& rate, bool is_stopped) {
  const auto passed = rate.at("passed").get<std::int64_t>();
  const auto draws = rate.at("draws").get<std::int64_t>();
  const std::string note = is_stopped ? "<span class=\"note\"> not valid after stopping</span>" : "";
  return "<tr data-requirement=\"" + name + "\"><th scope=\"row\">" +
         (name == "all"                 ? "all six"
          : name == "all_and_own"       ? "all six and own"
          : name == "chosen_place_safe" ? "chosen place truly safe"
          : name == "landing_safe"      ? "safe landing with the lidar"
          : name == "blind_safe"        ? "safe landing without a lidar"
                                        : name) +
         "</th>" + number_cell(grouped(passed) + " of " + grouped(draws)) +
         number_cell(percent_text(static_cast<double>(passed) / static_cast<double>(draws))) +
         number_cell(p_text(rate.at("wilson_low")) + " \u2026 " + p_text(rate.at("wilson_high")) + note) +
         number_cell(p_text(rate.at("exact_lower_bound")) + note) + "</tr>\n";
}

std::string rates_html(const Json& verdict) {
  std::string text =
      "<table id=\"rates\"><thead><tr><th>requirement</th><th class=\"number\">passed</th><th "
      "class=\"number\">share"
      "</th><th class=\"number\">Wilson interval, 95 %</th><th class=\"number\">probability at least, 95 "
      "%</th></tr>"
      "</thead><tbody>\n";
  const auto rows = [&](const Json& result) {
    const bool is_stopped = verdict.contains("sprt");
    for (const Json& rate : result.at("rates"))
      text += rate_row_html(rate.at("requirement"), rate, is_stopped);
    if (result.contains("hazard"))
      text += rate_row_html("chosen_place_safe", result.at("hazard").at("chosen_place_safe"), is_stopped);
    if (!result.contains("landing")) return;
    text += rate_row_html("landing_safe", result.at("landing").at("safe"), is_stopped);
    text += rate_row_html("blind_safe", result.at("landing").at("blind"), is_stopped);
  };
  const auto heading = [&](const std::string& of) {
    text += "<tr><th colspan=\"5\" scope=\"rowgroup\">" + of + "</th></tr>\n";
  };
  if (verdict.contains("pairs")) {
    for (const Json& pair : verdict.at("pairs")) {
      heading("pair " + std::to_string(pair.at("pair").get<int>()));
      rows(pair);
    }
    heading("all pairs, for these terrains");
  }
  rows(verdict);
  return text + "</tbody></table>\n";
}

std::string banner_html(const Json& verdict) {
  const Json& all = verdict.at("rates").back();
  const bool all_pass = all.at("passed") == all.at("draws");
  std::string text = grouped(all.at("passed").get<std::int64_t>()) + " of " +
                     grouped(all.at("draws").get<std::int64_t>()) + " draws pass all requirements";
  std::string kind = all_pass ? "pass" : "fail";
  if (verdict.contains("sprt")) {
    const auto state = verdict.at("sprt").get<std::string>();
    text += "; sequential test: " + state;
    kind = state == "accepted" ? "pass" : state == "rejected" ? "fail" : "unjudged";
  } else {
    text += ": the probability of passing is at least " + p_text(all.at("exact_lower_bound")) + " (95 %)";
  }
  return "<div class=\"banner " + kind + "\" id=\"verdict\">" + text + "</div>";
}

}  // namespace

std::string draws_page(const DrawsReport& content, const Provenance& provenance, const std::string& title) {
  nlohmann::json steps = provenance.chain;
  steps.push_back(provenance.as_step());
  return page_html("draws.html",
                   {{"title", html_text(title.empty() ? title_of(steps, "Campaign of draws") : title)},
                    {"subtitle", subtitle_html(steps, "draws", "scan", "scan")},
                    {"banner", banner_html(content.verdict)},
                    {"rates", rates_html(content.verdict)},
                    {"provenance", provenance_html(steps)},
                    {"data", data_html(draws_data(content, provenance.config))}});
}

}  // namespace landfall::html_report
