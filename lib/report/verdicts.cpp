// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/verdicts.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace landfall::html_report {
namespace {

std::string number(double value, RequirementUnit unit) {
  const bool is_fraction = unit == RequirementUnit::fraction;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.6g", std::abs(is_fraction ? 100 * value : value));
  std::string digits = (value < 0 ? "\u2212" : "") + std::string(text.data());  // a minus, as in the diagrams
  if (is_fraction) return digits + " %";
  if (unit == RequirementUnit::footprints) return digits;
  return digits + (value == 1 ? " bin" : " bins");
}

std::string shown(const std::optional<double>& value, RequirementUnit unit) {
  return value && std::isfinite(*value) ? number(*value, unit) : "\u2013";
}

/// Removes the sign of a negative zero.
std::optional<double> margin(const Requirement& r, bool at_least) {
  if (!r.value) return std::nullopt;
  const double difference = at_least ? *r.value - r.limit : r.limit - *r.value;
  return difference == 0 ? 0 : difference;
}

const char* verdict_class(const std::optional<bool>& pass) {
  return !pass ? "unjudged" : *pass ? "pass" : "fail";
}

const char* verdict_word(const std::optional<bool>& pass) {
  return !pass ? "not judged" : *pass ? "pass" : "FAIL";
}

std::string cell(const std::string& text) { return "<td class=\"number\">" + text + "</td>"; }

std::string row_html(const RequirementInfo& words, const Requirement& r) {
  return std::string("<tr data-requirement=\"") + words.name + "\"><th scope=\"row\">" + words.name +
         "</th><td>" + words.measured + "</td>" + cell(shown(r.value, words.unit)) +
         cell((words.at_least ? "at least " : "at most ") + shown(r.limit, words.unit)) +
         cell(shown(margin(r, words.at_least), words.unit)) + "<td><span class=\"verdict " +
         verdict_class(r.pass) + "\">" + verdict_word(r.pass) + "</span></td></tr>\n";
}

}  // namespace

std::string verdict_table_html(const Metrics& metrics) {
  std::string text =
      "<table id=\"verdicts\"><thead><tr><th>requirement</th><th>measured</th><th class=\"number\">value</th>"
      "<th class=\"number\">limit</th><th class=\"number\">margin</th><th>verdict</th></tr></thead><tbody>\n";
  for (const RequirementInfo& words : kRequirementInfo)
    text += row_html(words, metrics.requirements.*words.requirement);
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
    text += (text.empty() ? "" : ", ") + std::to_string(unjudged) + " of 6 not judged: the DEM has no truth";
  if (text.empty()) text = "all 6 requirements met";
  const std::optional<bool> pass = missed > 0 ? std::optional(false) : metrics.pass;
  return std::string("<div class=\"banner ") + verdict_class(pass) + "\" id=\"verdict\">" +
         verdict_word(pass) + ": " + text + "</div>";
}

}  // namespace landfall::html_report
