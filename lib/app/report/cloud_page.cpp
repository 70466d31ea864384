// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/cloud_page.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "app/report/escape.h"
#include "app/report/heading.h"
#include "app/report/page_parts.h"
#include "app/report/quantised.h"
#include "app/report/report_layer.h"
#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "base/returns/point_status.h"
#include "base/text/number_text.h"

namespace landfall::html_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kPlaceSteps = 50000;  ///< 2 mm of 100 m
constexpr int kCloudErrorSteps = 500;
constexpr int kValueSteps = 1000;
constexpr int kTimeSteps = 5'000'000;  ///< every pulse of 2 s at 1 MHz has a time of its own
constexpr double kMaxCode = 4294967294.0;
constexpr double kOutlierShare = 0.005;
constexpr double kRounding = 1 - 1e-12;  ///< of a step that is a round number

double quantile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::ranges::nth_element(values, values.begin() + rank);
  return values[static_cast<std::size_t>(rank)];
}

/// A column of the page.
struct Described {
  const char* name;
  const char* title;
  const char* unit;
  const char* style;   ///< of the page's scripts; empty: it is no colour
  const char* colors;  ///< the colour map
  const char* quantity;
  int steps;
};

constexpr const char* kError = "true \u2212 estimated";
constexpr Described kColumns[] = {
    {"x_est", "x", "m", "", "", "", kPlaceSteps},
    {"y_est", "y", "m", "", "", "", kPlaceSteps},
    {"z_est", "Elevation", "m", "elevation", "elevation", "elevation", kPlaceSteps},
    {"e_z", "Vertical error", "m", "signed", "error", kError, kCloudErrorSteps},
    {"e_horizontal", "Horizontal error", "m", "magnitude", "magnitude", "distance, true to estimated",
     kCloudErrorSteps},
    {"e_range", "Range error", "m", "signed", "error", "measured \u2212 true", kCloudErrorSteps},
    {"range_measured", "Measured range", "m", "quantity", "magnitude", "range", kPlaceSteps},
    {"range_true", "True range", "m", "", "", "", kPlaceSteps},
    {"t", "Time", "s", "quantity", "magnitude", "time", kTimeSteps},
    {"status", "Status", "", "classes", "", "", 1},
    {"intensity", "Intensity", "", "quantity", "magnitude", "intensity", kValueSteps},
    {"return_number", "Return number", "", "quantity", "magnitude", "return number", 1},
    {"pulse", "Pulse", "", "quantity", "magnitude", "pulse", 1},
    {"pixel", "Pixel", "", "quantity", "magnitude", "pixel", 1},
};

/// The colours are Okabe and Ito's.
OrderedJson status_flags(const std::vector<double>& status) {
  const auto flag = [&](PointStatus value, const char* text, std::uint32_t color) {
    const auto code = static_cast<int>(value);
    const auto count = std::ranges::count(status, static_cast<double>(code));
    return OrderedJson{{"bits", 1 << code}, {"text", text}, {"color", css_color(color)}, {"count", count}};
  };
  return {flag(PointStatus::false_return, "false return", 0xd55e00),
          flag(PointStatus::returned, "return", 0x0072b2)};
}

/// A column of the file, or an error that follows from others; nothing if the file lacks them.
std::optional<std::vector<double>> values_of(const CloudContent& content, const std::string& name) {
  static const std::map<std::string, std::vector<std::string>> kErrors = {
      {"e_z", {"z_true", "z_est"}},
      {"e_range", {"range_measured", "range_true"}},
      {"e_horizontal", {"x_true", "x_est", "y_true", "y_est"}}};
  const auto error = kErrors.find(name);
  std::vector<const std::vector<double>*> parts;
  for (const std::string& part : error == kErrors.end() ? std::vector{name} : error->second) {
    const auto column = content.columns.find(part);
    if (column == content.columns.end()) return std::nullopt;
    parts.push_back(&column->second);
  }
  std::vector<double> result = *parts[0];
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (parts.size() > 1) result[i] -= (*parts[1])[i];
    if (parts.size() > 2) result[i] = portable::hypot(result[i], (*parts[2])[i] - (*parts[3])[i]);
  }
  return result;
}

std::vector<std::uint16_t> half_of(const std::vector<std::uint32_t>& codes, unsigned shift) {
  std::vector<std::uint16_t> half(codes.size());
  std::ranges::transform(codes, half.begin(),
                         [shift](std::uint32_t code) { return static_cast<std::uint16_t>(code >> shift); });
  return half;
}

struct PageColumn {
  OrderedJson description;
  std::vector<std::pair<std::string, std::string>> packed;
};

PageColumn page_column(const CloudContent& content, const Described& d, std::vector<double> values) {
  OrderedJson flags = nullptr;
  if (std::string(d.style) == "classes") {
    flags = status_flags(values);
    for (double& value : values) value = portable::exp2(value);  // flags need the bit of a status
  }
  const WideCodes wide = wide_codes(values, d.steps);
  std::string title = d.title;
  if (std::string(d.name) == "t")
    title += content.has_pulses ? " since the first pulse" : " since the earliest point";
  PageColumn column{{{"name", d.name},
                     {"title", title},
                     {"unit", d.unit},
                     {"style", d.style},
                     {"colors", d.colors},
                     {"quantity", d.quantity},
                     {"low", wide.low},
                     {"high", wide.high},
                     {"offset", wide.offset},
                     {"step", wide.step},
                     {"limit", nullptr},
                     {"flags", flags}},
                    {{std::string(d.name) + "-low", packed(half_of(wide.codes, 0))}}};
  if (std::ranges::any_of(wide.codes, [](std::uint32_t code) { return code > 0xffff; }))
    column.packed.emplace_back(std::string(d.name) + "-high", packed(half_of(wide.codes, 16)));
  return column;
}

std::string length_text(double value_m) {
  return value_m < 1 ? short_number(100 * value_m) + " cm" : short_number(value_m) + " m";
}

std::string thinning_text(const CloudContent& content) {
  const auto shown = grouped(static_cast<std::int64_t>(content.size()));
  if (content.cell_m == 0) return "All " + shown + " returns of the scan are shown.";
  return shown + " of the scan's " + grouped(static_cast<std::int64_t>(content.all_count)) +
         " returns are shown: one at random of each cell of " + length_text(content.cell_m) +
         ", seen from above.";
}

}  // namespace

WideCodes wide_codes(std::span<const double> values, int steps) {
  WideCodes result;
  result.codes.assign(values.size(), kNoWideCode);
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  if (finite.empty()) return result;
  const auto [minimum, maximum] = std::ranges::minmax(finite);
  result.low = minimum;
  result.high = maximum;
  const bool is_whole = std::ranges::all_of(finite, [](double value) { return value == std::round(value); });
  const double middle = quantile(finite, 1 - kOutlierShare) - quantile(finite, kOutlierShare);
  const double span = middle > 0 ? middle : maximum - minimum;
  const double finest = std::max(is_whole ? 1 : span / steps, (maximum - minimum) / (kMaxCode - 1));
  if (finest > 0) result.step = round_step(finest * kRounding);
  const double first = std::floor(minimum / result.step);
  result.offset = first * result.step;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i]))
      result.codes[i] =
          static_cast<std::uint32_t>(std::clamp(std::round(values[i] / result.step - first), 0.0, kMaxCode));
  return result;
}

ReportData cloud_data(const CloudContent& content) {
  std::vector<std::pair<const Described*, std::vector<double>>> present;
  for (const Described& d : kColumns)
    if (auto values = values_of(content, d.name)) present.emplace_back(&d, std::move(*values));
  std::vector<PageColumn> columns(present.size());
  parallel_for(present.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      columns[i] = page_column(content, *present[i].first, std::move(present[i].second));
  });
  ReportData data;
  OrderedJson layers = OrderedJson::array();
  for (PageColumn& column : columns) {
    layers.push_back(std::move(column.description));
    std::ranges::move(column.packed, std::back_inserter(data.packed));
  }
  data.values = {{"count", content.size()},
                 {"all_count", content.all_count},
                 {"cell_m", content.cell_m},
                 {"colors", colors_json()},
                 {"layers", std::move(layers)}};
  return data;
}

std::string cloud_page(const CloudContent& content, const nlohmann::json& steps) {
  const nlohmann::json inputs = member(steps.back(), "inputs");
  const std::string role = inputs.empty() ? "input" : member(inputs.front(), "role").get<std::string>();
  return page_html("cloud.html", {{"title", html_text(title_of(steps, "Scan"))},
                                  {"subtitle", subtitle_html(steps, "scan", html_text(role), role)},
                                  {"banner", ""},
                                  {"thinning", thinning_text(content)},
                                  {"provenance", provenance_html(steps, "this scan")},
                                  {"data", data_html(cloud_data(content))}});
}

}  // namespace landfall::html_report
