// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page.h"

#include <map>
#include <stdexcept>
#include <string_view>

#include "report/embedded_assets.h"
#include "report/escape.h"
#include "report/heading.h"
#include "report/verdicts.h"

namespace landfall::html_report {
namespace {

/// Null if the file that the object came from has an unexpected structure.
nlohmann::json member(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nlohmann::json() : *found;
}

std::string text_of(const nlohmann::json& object, const char* key) {
  const nlohmann::json value = member(object, key);
  if (value.is_null()) return "\u2013";
  return html_text(value.is_string() ? value.get<std::string>() : value.dump());
}

std::string pretty(const nlohmann::json& value) {
  return html_text(value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string inputs_html(const nlohmann::json& step) {
  std::string text;
  for (const nlohmann::json& input : member(step, "inputs"))
    text += (text.empty() ? "" : "<br>") + text_of(input, "role") + " <code>" + text_of(input, "file_id") +
            "</code>";
  return text.empty() ? "\u2013" : text;
}

std::string configuration_html(const nlohmann::json& step) {
  std::string text = "<details><summary>" + text_of(step, "tool") + ": configuration</summary><pre>" +
                     pretty(member(step, "config")) + "</pre>";
  const nlohmann::json options = member(step, "options");
  if (!options.is_null()) text += "<p>Options:</p><pre>" + pretty(options) + "</pre>";
  return text + "</details>\n";
}

std::string provenance_html(const nlohmann::json& steps) {
  std::string text =
      "<div class=\"scroll\"><table id=\"provenance\"><thead><tr><th class=\"number\">step</th><th>tool</th>"
      "<th>version</th><th>file_id</th><th>inputs</th></tr></thead><tbody>\n";
  std::string configurations;
  int index = 0;
  for (const nlohmann::json& step : steps) {
    text += "<tr><td class=\"number\">" + std::to_string(++index) + "</td><td>" + text_of(step, "tool") +
            "</td><td>" + text_of(step, "version") + "</td><td><code>" + text_of(step, "file_id") +
            "</code></td><td>" + inputs_html(step) + "</td></tr>\n";
    configurations += configuration_html(step);
  }
  return text + "</tbody></table></div>\n" + configurations;
}

/// Data in script elements is not executed by the browser.
std::string data_html(const ReportData& data) {
  std::string text =
      "<script type=\"application/json\" id=\"report-data\">" + script_json(data.values) + "</script>\n";
  for (const auto& [id, packed] : data.packed)
    text += "<script type=\"text/plain\" id=\"layer-" + html_text(id) + "\">" + packed + "</script>\n";
  return text;
}

std::string asset(std::string_view name) {
  for (const auto& asset : embedded::kAssets)
    if (asset.name == name) return asset.text;
  throw std::logic_error("no embedded asset " + std::string(name));
}

/// Each script in its own element, in the order of their use.
std::string programs_html() {
  std::string text;
  for (const char* const name :
       {"theme.js", "data.js", "scales.js", "relief.js", "table.js", "colorbar.js", "cursor.js", "map.js",
        "chart.js", "profile.js", "crops.js", "terrain3d.js", "report.js"})
    text += "<script>\n" + asset(name) + "</script>\n";
  return text;
}

std::string subtitle_html(const nlohmann::json& steps) {
  const nlohmann::json& evaluation = steps.back();

  std::string dem = "\u2013";
  for (const nlohmann::json& input : member(evaluation, "inputs"))
    if (member(input, "role") == "dem") dem = text_of(input, "file_id");
  const std::string origin = origin_of(steps);
  return (origin.empty() ? "" : html_text(origin) + "<br>") + "landfall dem-eval " +
         text_of(evaluation, "version") + ", evaluation <code>" + text_of(evaluation, "file_id") +
         "</code> of DEM <code>" + dem + "</code>";
}

/// Replaces each @NAME@ in the template by its value in `parts`.
std::string filled(const std::string& page, const std::map<std::string, std::string>& parts) {
  std::string text;
  std::size_t at = 0;
  while (true) {
    const std::size_t begin = page.find('@', at);
    const std::size_t end = begin == std::string::npos ? begin : page.find('@', begin + 1);
    if (end == std::string::npos) return text + page.substr(at);
    const auto part = parts.find(page.substr(begin + 1, end - begin - 1));
    text += page.substr(at, begin - at);
    text += part == parts.end() ? "@" : part->second;
    at = part == parts.end() ? begin + 1 : end + 1;
  }
}

}  // namespace

std::string report_page(const ReportContent& content) {
  const Metrics& metrics = content.evaluation.metrics;
  const std::string title = content.title.empty() ? title_of(content.steps) : content.title;
  return filled(asset("report.html"), {{"style", asset("report.css")},
                                       {"title", html_text(title)},
                                       {"subtitle", subtitle_html(content.steps)},
                                       {"banner", verdict_banner_html(metrics)},
                                       {"verdicts", verdict_table_html(metrics)},
                                       {"provenance", provenance_html(content.steps)},
                                       {"data", data_html(report_data(content))},
                                       {"programs", programs_html()}});
}

Report::Report(const std::filesystem::path& path, const DemLayers& dem,
               const EvaluationParameters& parameters)
    : ReportLayers(dem.z_est.spec(), parameters), parameters_(parameters), dem_(path) {
  take(dem);
  if (const auto count = dem_.count()) take(*count);
}

std::string Report::page(const Evaluation& evaluation, const Provenance& provenance,
                         const std::string& title) const {
  nlohmann::json steps = provenance.chain;
  steps.push_back(provenance.as_step());
  const auto worst =
      worst_footprints(shares(), parameters_, [this](const GridSpec& window) { return dem_.read(window); });
  return report_page({parameters_, evaluation, *this, worst, steps, title});
}

}  // namespace landfall::html_report
