// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page_parts.h"

#include <array>
#include <cstdio>
#include <stdexcept>

#include "base/joined.h"
#include "report/embedded_pages.h"
#include "report/escape.h"
#include "report/heading.h"

namespace landfall::html_report {
namespace {

std::string pretty(const nlohmann::json& value) {
  return html_text(value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string inputs_html(const nlohmann::json& step) {
  const std::string text = joined(member(step, "inputs"), "<br>", [](const nlohmann::json& input) {
    return text_of(input, "role") + " <code>" + text_of(input, "file_id") + "</code>";
  });
  return text.empty() ? "\u2013" : text;
}

std::string configuration_html(const nlohmann::json& step) {
  std::string text = "<details><summary>" + text_of(step, "tool") + ": configuration</summary><pre>" +
                     pretty(member(step, "config")) + "</pre>";
  const nlohmann::json options = member(step, "options");
  if (!options.is_null()) text += "<p>Options:</p><pre>" + pretty(options) + "</pre>";
  return text + "</details>\n";
}

std::string template_of(std::string_view name) {
  for (const auto& page : embedded::kPages)
    if (page.name == name) return page.text;
  throw std::logic_error("no embedded page " + std::string(name));
}

/// The template with each @NAME@ replaced by its value in `parts`.
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

nlohmann::json member(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nlohmann::json() : *found;
}

std::string text_of(const nlohmann::json& object, const char* key) {
  const nlohmann::json value = member(object, key);
  if (value.is_null()) return "\u2013";
  return html_text(value.is_string() ? value.get<std::string>() : value.dump());
}

std::string probability_text(double p) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f", p);
  return text.data();
}

std::string provenance_html(const nlohmann::json& steps, const std::string& what) {
  std::string text =
      "<section id=\"provenance-chain\">\n<h2>Configuration and provenance</h2>\n<p class=\"note\">What led "
      "to " +
      what +
      ", oldest first. Equal file_id means equal content.</p>\n"
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
  return text + "</tbody></table></div>\n" + configurations + "\n</section>";
}

std::string subtitle_html(const nlohmann::json& steps, const std::string& output, const std::string& input,
                          const std::string& role) {
  const nlohmann::json& last = steps.back();
  std::string file_id = "\u2013";
  for (const nlohmann::json& source : member(last, "inputs"))
    if (member(source, "role") == role) file_id = text_of(source, "file_id");
  const std::string origin = origin_of(steps);
  return "<p class=\"note\">" + (origin.empty() ? "" : html_text(origin) + "<br>") + "landfall " +
         text_of(last, "tool") + " " + text_of(last, "version") + ", " + output + " <code>" +
         text_of(last, "file_id") + "</code> of " + input + " <code>" + file_id + "</code></p>";
}

std::string data_html(const ReportData& data) {
  std::string text =
      "<script type=\"application/json\" id=\"report-data\">" + script_json(data.values) + "</script>\n";
  for (const auto& [id, packed] : data.packed)
    text += "<script type=\"text/plain\" id=\"layer-" + html_text(id) + "\">" + packed + "</script>\n";
  return text;
}

std::string page_html(std::string_view name, const std::map<std::string, std::string>& parts) {
  return filled(template_of(name), parts);
}

}  // namespace landfall::html_report
