// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/verdicts.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace landfall::html_report {
namespace {

struct Row {
  const char* name;
  const char* text;
  const char* sense;
  const char* unit;
  bool at_least;
  bool is_fraction;
  const Requirement& requirement;
};

std::array<Row, 6> rows_of(const RequirementMetrics& r) {
  return {{{"coverage", "invalid bins, share of the region", "at most", "%", false, true, r.coverage},
           {"hole_size", "largest hole", "at most", "bins", false, false, r.hole_size},
           {"hole_distance", "farthest invalid bin from a valid one", "at most", "bins", false, false,
            r.hole_distance},
           {"relative_elevation", "footprints over the limit, z", "at most", "", false, false,
            r.relative_elevation},
           {"relative_horizontal", "footprints over the limit, x and y", "at most", "", false, false,
            r.relative_horizontal},
           {"absolute_horizontal", "footprints within the limit", "at least", "%", true, true,
            r.absolute_horizontal}}};
}

std::string number(double value, const Row& row) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.6g", std::abs(row.is_fraction ? 100 * value : value));
  const std::string unit = row.unit;
  if (unit == "bins" && value == 1) return "1 bin";
  const std::string sign = value < 0 ? "\u2212" : "";  // a minus, as in the diagrams
  return sign + text.data() + (unit.empty() ? "" : " " + unit);
}

std::string shown(const std::optional<double>& value, const Row& row) {
  return value && std::isfinite(*value) ? number(*value, row) : "\u2013";
}

/// Zero is no negative zero.
std::optional<double> margin(const Row& row) {
  const Requirement& r = row.requirement;
  if (!r.value) return std::nullopt;
  const double difference = row.at_least ? *r.value - r.limit : r.limit - *r.value;
  return difference == 0 ? 0 : difference;
}

const char* verdict_class(const std::optional<bool>& pass) {
  return !pass ? "unjudged" : *pass ? "pass" : "fail";
}

const char* verdict_word(const std::optional<bool>& pass) {
  return !pass ? "not judged" : *pass ? "pass" : "FAIL";
}

std::string cell(const std::string& text) { return "<td class=\"number\">" + text + "</td>"; }

std::string row_html(const Row& row) {
  const Requirement& r = row.requirement;
  return std::string("<tr data-requirement=\"") + row.name + "\"><th scope=\"row\">" + row.name +
         "</th><td>" + row.text + "</td>" + cell(shown(r.value, row)) +
         cell(std::string(row.sense) + " " + shown(r.limit, row)) + cell(shown(margin(row), row)) +
         "<td><span class=\"verdict " + verdict_class(r.pass) + "\">" + verdict_word(r.pass) +
         "</span></td></tr>\n";
}

}  // namespace

std::string verdict_table_html(const Metrics& metrics) {
  std::string text =
      "<table id=\"verdicts\"><thead><tr><th>requirement</th><th>measured</th><th class=\"number\">value</th>"
      "<th class=\"number\">limit</th><th class=\"number\">margin</th><th>verdict</th></tr></thead><tbody>\n";
  for (const Row& row : rows_of(metrics.requirements)) text += row_html(row);
  return text + "</tbody></table>";
}

std::string verdict_banner_html(const Metrics& metrics) {
  std::string text;
  int missed = 0;
  int unjudged = 0;
  for (const Row& row : rows_of(metrics.requirements)) {
    if (!row.requirement.pass) ++unjudged;
    if (row.requirement.pass == false) ++missed;
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
