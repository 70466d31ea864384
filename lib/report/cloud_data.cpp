// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/cloud_data.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/portable_math.h"
#include "report/quantised.h"
#include "report/report_layer.h"
#include "returns/point_status.h"

namespace landfall::html_report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPlaceSteps = 50000;  ///< 2 mm of 100 m
constexpr int kCloudErrorSteps = 500;
constexpr int kValueSteps = 1000;
constexpr int kTimeSteps = 5'000'000;  ///< every pulse of 2 s at 1 MHz has a time of its own
constexpr double kMaxCode = 4294967294.0;
constexpr double kOutlierShare = 0.005;
constexpr double kRounding = 1 - 1e-12;  ///< of a step that is a round number

std::vector<double> finite_values(std::span<const double> values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  return finite;
}

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
Json status_flags(const std::vector<double>& status) {
  const auto flag = [&](PointStatus value, const char* text, std::uint32_t color) {
    const auto code = static_cast<int>(value);
    const auto count = std::ranges::count(status, static_cast<double>(code));
    return Json{{"bits", 1 << code}, {"text", text}, {"color", css_color(color)}, {"count", count}};
  };
  return {flag(PointStatus::false_return, "false return", 0xd55e00),
          flag(PointStatus::returned, "return", 0x0072b2)};
}

/// A column of the file, or an error that follows from others; nothing if the file lacks them.
std::optional<std::vector<double>> values_of(const CloudContent& content, const std::string& name) {
  const auto column = [&](const std::string& wanted) -> const std::vector<double>* {
    const auto found = content.columns.find(wanted);
    return found == content.columns.end() ? nullptr : &found->second;
  };
  const auto combined = [&](const std::vector<std::string>& names,
                            const std::function<double(const std::vector<double>&)>& combine)
      -> std::optional<std::vector<double>> {
    std::vector<const std::vector<double>*> parts;
    for (const std::string& wanted : names) parts.push_back(column(wanted));
    if (std::ranges::count(parts, nullptr) > 0) return std::nullopt;
    std::vector<double> result(content.size());
    std::vector<double> row(parts.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
      for (std::size_t k = 0; k < parts.size(); ++k) row[k] = (*parts[k])[i];
      result[i] = combine(row);
    }
    return result;
  };
  if (name == "e_z") return combined({"z_true", "z_est"}, [](const auto& v) { return v[0] - v[1]; });
  if (name == "e_range")
    return combined({"range_measured", "range_true"}, [](const auto& v) { return v[0] - v[1]; });
  if (name == "e_horizontal")
    return combined({"x_true", "x_est", "y_true", "y_est"},
                    [](const auto& v) { return portable::hypot(v[0] - v[1], v[2] - v[3]); });
  return combined({name}, [](const auto& v) { return v[0]; });
}

/// Flags need the bit of a status, not its number.
void to_bits(std::vector<double>& status) {
  for (double& value : status) value = portable::exp2(value);
}

std::vector<std::uint16_t> half_of(const std::vector<std::uint32_t>& codes, unsigned shift) {
  std::vector<std::uint16_t> half(codes.size());
  std::ranges::transform(codes, half.begin(),
                         [shift](std::uint32_t code) { return static_cast<std::uint16_t>(code >> shift); });
  return half;
}

struct PageColumn {
  Json description;
  std::vector<std::pair<std::string, std::string>> packed;
};

PageColumn page_column(const CloudContent& content, const Described& d, std::vector<double> values) {
  Json flags = nullptr;
  if (std::string(d.style) == "classes") {
    flags = status_flags(values);
    to_bits(values);
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

}  // namespace

WideCodes wide_codes(std::span<const double> values, int steps) {
  WideCodes result;
  result.codes.assign(values.size(), kNoWideCode);
  std::vector<double> finite = finite_values(values);
  if (finite.empty()) return result;
  const auto [least, greatest] = std::ranges::minmax(finite);
  result.low = least;
  result.high = greatest;
  const bool is_whole = std::ranges::all_of(finite, [](double value) { return value == std::round(value); });
  const double middle = quantile(finite, 1 - kOutlierShare) - quantile(finite, kOutlierShare);
  const double span = middle > 0 ? middle : greatest - least;
  const double finest = std::max(is_whole ? 1 : span / steps, (greatest - least) / (kMaxCode - 1));
  if (finest > 0) result.step = round_step(finest * kRounding);
  const double first = std::floor(least / result.step);
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
  Json layers = Json::array();
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

}  // namespace landfall::html_report
