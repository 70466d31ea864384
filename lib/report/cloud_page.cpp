// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/cloud_page.h"

#include "base/number_text.h"
#include "report/escape.h"
#include "report/heading.h"
#include "report/page_parts.h"

namespace landfall::html_report {
namespace {

std::string length_text(double value_m) {
  return value_m < 1 ? short_number(100 * value_m) + " cm" : short_number(value_m) + " m";
}

std::string thinning_text(const CloudContent& content) {
  const auto shown = grouped(static_cast<std::int64_t>(content.size()));
  if (content.cell_m == 0) return "All " + shown + " returns of the scan are shown.";
  return shown + " of the scan's " + grouped(static_cast<std::int64_t>(content.all_count)) +
         " returns are shown: of each square of " + length_text(content.cell_m) +
         ", seen from above, one at random.";
}

}  // namespace

std::string cloud_page(const CloudContent& content, const nlohmann::json& steps) {
  const nlohmann::json inputs = member(steps.back(), "inputs");
  const std::string role = inputs.empty() ? "input" : member(inputs.front(), "role").get<std::string>();
  return page_html("cloud.html", {{"title", html_text(title_of(steps, "Scan"))},
                                  {"subtitle", subtitle_html(steps, "scan", html_text(role), role)},
                                  {"banner", ""},
                                  {"thinning", thinning_text(content)},
                                  {"provenance", provenance_html(steps)},
                                  {"data", data_html(cloud_data(content))}});
}

}  // namespace landfall::html_report
