// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/page_parts.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>

#include "app/embedded_pages.h"
#include "app/report/escape.h"
#include "app/report/heading.h"
#include "base/core/parallel.h"
#include "base/dictionary/tables/layers.h"
#include "base/text/joined.h"
#include "formats/picture/color_map.h"

namespace landfall::html_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

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

OrderedJson Packer::add(const ReportLayer& layer, const std::string& id) {
  ids_.push_back(id);
  codes_.emplace_back(layer.values.codes);
  return layer_json(layer, id);
}

std::vector<std::pair<std::string, std::string>> Packer::pack() const {
  std::vector<std::pair<std::string, std::string>> result(ids_.size());
  parallel_for(ids_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = {ids_[i], packed(codes_[i])};
  });
  return result;
}

OrderedJson grid_json(const GridSpec& spec, std::int64_t factor) {
  return {{"rows", spec.rows},
          {"cols", spec.cols},
          {"resolution_m", spec.resolution_m},
          {"x_m", spec.x(0)},
          {"y_m", spec.y(0)},
          {"factor", factor},
          {"cell_rows", (spec.rows + factor - 1) / factor},
          {"cell_cols", (spec.cols + factor - 1) / factor}};
}

OrderedJson colors_json() {
  OrderedJson maps = OrderedJson::object();
  for (std::size_t k = 0; k < kColorMaps; ++k) {
    const auto colors = static_cast<Colors>(k);
    OrderedJson anchors = OrderedJson::array();
    for (const std::uint32_t rrggbb : color_anchors(colors)) anchors.push_back(rrggbb);
    maps[name_of(colors)] = std::move(anchors);
  }
  return {{"maps", std::move(maps)},
          {"no_value", kNoValueColor},
          {"mark", kMarkColor},
          {"outliers", dictionary::kOutliers},
          {"limit_inside", dictionary::kLimitInside},
          {"limit_near", dictionary::kLimitNear}};
}

OrderedJson groups_json(std::string_view page) {
  OrderedJson titles = OrderedJson::array();
  for (const dictionary::Group& group : dictionary::kGroups)
    if (group.page == page) titles.push_back(group.title);
  return titles;
}

GridSpec window_about(BinIndex bin, std::int64_t half, const GridSpec& map) {
  const BinIndex first{std::max<std::int64_t>(0, bin.row - half), std::max<std::int64_t>(0, bin.col - half)};
  const BinIndex end{std::min(map.rows, bin.row + half + 1), std::min(map.cols, bin.col + half + 1)};
  return {map.resolution_m, map.first_row + first.row, map.first_col + first.col, end.row - first.row,
          end.col - first.col};
}

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
  std::string of;  // without an input of this role, such as a scan of draws that trace, empty
  for (const nlohmann::json& source : member(last, "inputs"))
    if (member(source, "role") == role)
      of = " of " + input + " <code>" + text_of(source, "file_id") + "</code>";
  const std::string origin = origin_of(steps);
  return "<p class=\"note\">" + (origin.empty() ? "" : html_text(origin) + "<br>") + "landfall " +
         text_of(last, "tool") + " " + text_of(last, "version") + ", " + output + " <code>" +
         text_of(last, "file_id") + "</code>" + of + "</p>";
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
