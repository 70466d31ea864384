// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/verdicts.h"

#include <optional>

#include "evaluation/verdict_text.h"
#include "report/escape.h"

namespace landfall::html_report {
namespace {

const char* verdict_class(const std::optional<bool>& pass) {
  return !pass ? "unjudged" : *pass ? "pass" : "fail";
}

const char* verdict_word(const std::optional<bool>& pass) {
  return !pass ? "not judged" : *pass ? "pass" : "FAIL";
}

std::string row_html(const VerdictText& text, const Requirement& r) {
  return std::string("<tr data-requirement=\"") + text.name + "\"><th scope=\"row\">" + text.name +
         "</th><td>" + html_text(text.value) + "</td><td class=\"number\">" + html_text(text.limit) +
         "</td><td><span class=\"verdict " + verdict_class(r.pass) + "\">" + text.verdict +
         "</span></td></tr>\n";
}

}  // namespace

std::string verdict_table_html(const Metrics& metrics, const EvaluationLimits& limits) {
  std::string text =
      "<table id=\"verdicts\"><thead><tr><th>requirement</th><th>measured</th><th class=\"number\">limit</th>"
      "<th>verdict</th></tr></thead><tbody>\n";
  const auto rows = verdict_texts(metrics, limits);
  for (std::size_t i = 0; i < rows.size(); ++i)
    text += row_html(rows[i], metrics.requirements.*kRequirementInfo[i].requirement);
  return text + "</tbody></table>";
}

std::string verdict_banner_html(const Metrics& metrics) {
  std::string text;
  int missed = 0;
  int unjudged = 0;
  for (const RequirementInfo& words : kRequirementInfo) {
    const Requirement& requirement = metrics.requirements.*words.requirement;
    if (!requirement.pass) ++unjudged;
    if (requirement.pass == false) ++missed;
  }
  if (missed > 0) text = std::to_string(missed) + " of 6 requirements missed";
  if (unjudged > 0)
    text += (text.empty() ? "" : ", ") + std::to_string(unjudged) + " of 6 not judged: the DEM has no " +
            (metrics.accuracy ? "true positions" : "truth");
  if (text.empty()) text = "all 6 requirements met";
  const std::optional<bool> pass = missed > 0 ? std::optional(false) : metrics.pass;
  return std::string("<div class=\"banner ") + verdict_class(pass) + "\" id=\"verdict\">" +
         verdict_word(pass) + ": " + text + "</div>";
}

}  // namespace landfall::html_report
