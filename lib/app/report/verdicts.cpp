// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/verdicts.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "app/report/escape.h"
#include "base/text/joined.h"
#include "chain/evaluation/verdict_text.h"

namespace landfall::html_report {
namespace {

const char* verdict_class(const std::optional<bool>& pass) {
  return !pass ? "unjudged" : *pass ? "pass" : "fail";
}

/// By the word of the table.
const char* verdict_class(const std::string& verdict) {
  return verdict == "not judged" ? "unjudged" : verdict == "pass" ? "pass" : "fail";
}

const char* verdict_word(const std::optional<bool>& pass) {
  return !pass ? "not judged" : *pass ? "pass" : "FAIL";
}

std::string row_html(const VerdictText& text) {
  const std::string name = html_text(text.name);
  return "<tr data-requirement=\"" + name + "\"><th scope=\"row\">" + name + "</th><td>" +
         html_text(text.value) + "</td><td class=\"number\">" + html_text(text.limit) +
         "</td><td><span class=\"verdict " + verdict_class(std::string(text.verdict)) + "\">" + text.verdict +
         "</span></td></tr>\n";
}

/// `id` is that of the table.
std::string table_html(const std::string& id, const std::vector<VerdictText>& rows) {
  std::string text = "<table id=\"" + id +
                     "\"><thead><tr><th>requirement</th><th>measured</th><th class=\"number\">limit</th>"
                     "<th>verdict</th></tr></thead><tbody>\n";
  for (const VerdictText& row : rows) text += row_html(row);
  return text + "</tbody></table>";
}

}  // namespace

std::string verdict_table_html(const Metrics& metrics, const EvaluationLimits& limits) {
  return table_html("verdicts", verdict_texts(metrics, limits));
}

std::string assumptions_html(const AssumptionMetrics& assumptions) {
  return "<p class=\"note\" id=\"assumptions\">Assumptions: " +
         html_text(joined(assumption_texts(assumptions), "; ")) + ".</p>";
}

std::string own_table_html(const RequirementVerdicts& own) {
  return own.all.empty() ? "" : table_html("own-requirements", own_texts(own));
}

std::string own_missed_text(const RequirementVerdicts& own) {
  const auto missed = std::ranges::count(own.all, false, &RequirementVerdict::pass);
  return missed == 0 ? ""
                     : std::to_string(missed) + " of " + std::to_string(own.all.size()) +
                           " custom requirements missed";
}

std::string verdict_banner_html(const Metrics& metrics) {
  std::string text;
  const std::vector<RequirementVerdict>& verdicts = metrics.requirements.all;
  const auto missed = std::ranges::count(verdicts, false, &RequirementVerdict::pass);
  const auto unjudged =
      std::ranges::count_if(verdicts, [](const RequirementVerdict& verdict) { return !verdict.pass; });
  const std::string all = std::to_string(verdicts.size());
  if (missed > 0) text = std::to_string(missed) + " of " + all + " requirements missed";
  if (unjudged > 0)
    text += (text.empty() ? "" : ", ") + std::to_string(unjudged) + " of " + all +
            " not judged: " + missing_text(metrics);
  if (text.empty()) text = "all " + all + " requirements met";
  const RequirementVerdicts& own = metrics.own_requirements;
  if (!all_pass(own))
    text += ", " + own_missed_text(own);
  else if (!own.all.empty())
    text += ", all " + std::to_string(own.all.size()) + " custom requirements met";
  const std::optional<bool> pass = missed > 0 ? std::optional(false) : metrics.pass;
  return std::string("<div class=\"banner ") + verdict_class(pass) + "\" id=\"verdict\">" +
         verdict_word(pass) + ": " + text + "</div>";
}

}  // namespace landfall::html_report
