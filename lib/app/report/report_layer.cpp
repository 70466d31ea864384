// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D154
#include "app/report/report_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string_view>

#include "base/dictionary/layers.h"
#include "base/numerics/non_finite.h"
#include "base/raster/by_rows.h"
#include "formats/picture/color_map.h"

namespace landfall::html_report {
namespace {

/// Chooses one of two values of a block.
double chosen(double a, double b, Rule rule) {
  switch (rule) {
    case Rule::extreme:
      return std::abs(b) > std::abs(a) || (b == -a && b > a) ? b : a;
    case Rule::largest:
      return std::max(a, b);
    case Rule::smallest:
      return std::min(a, b);
    case Rule::any_bit:
      return static_cast<double>(static_cast<std::int64_t>(a) | static_cast<std::int64_t>(b));
    case Rule::mean:
      return a + b;
  }
  return kNan;
}

template <class T>
double of_block(const Grid<T>& layer, BinIndex first, std::int64_t factor, Rule rule) {
  const BinIndex end{std::min(first.row + factor, layer.spec().rows),
                     std::min(first.col + factor, layer.spec().cols)};
  double result = kNan;
  std::int64_t count = 0;
  for (std::int64_t row = first.row; row < end.row; ++row) {
    for (std::int64_t col = first.col; col < end.col; ++col) {
      const auto value = static_cast<double>(layer.at({row, col}));
      if (!std::isfinite(value)) continue;
      result = count == 0 ? value : chosen(result, value, rule);
      ++count;
    }
  }
  return rule == Rule::mean && count > 0 ? result / static_cast<double>(count) : result;
}

using OrderedJson = nlohmann::ordered_json;

/// Errors have about as many steps as a colour map has shades, because digits of noise would enlarge the
/// file. Elevations have more steps, because relief is shown in three dimensions.
int steps_of(const ReportLayer& layer) {
  if (layer.steps > 0) return layer.steps;
  return layer.style == Style::signed_error || layer.style == Style::magnitude ? kErrorSteps : kMaxSteps;
}

bool is_whole(Style style) {
  return style == Style::count || style == Style::mask || style == Style::flags || style == Style::classes;
}

/// Uses a step of 1 or more, even for a small range of values.
Quantised quantise_whole(const std::vector<double>& cells) {
  Quantised result = quantise(cells, kMaxSteps);
  if (result.step >= 1 || result.high >= kMaxSteps || result.low < 0) return result;
  result.offset = 0;
  result.step = 1;
  std::ranges::transform(cells, result.codes.begin(), [](double value) {
    return std::isfinite(value) ? static_cast<std::uint16_t>(value) : kNoValueCode;
  });
  return result;
}

/// Shares in steps of 0.1 %, rounded up: only a block without any marked bin has the code 0.
Quantised quantise_shares(const std::vector<double>& cells) {
  constexpr double kSteps = 1000;
  Quantised result = quantise(cells, kMaxSteps);
  result.offset = 0;
  result.step = 1 / kSteps;
  std::ranges::transform(cells, result.codes.begin(), [](double share) {
    return static_cast<std::uint16_t>(std::ceil(share * kSteps - 1e-9));
  });
  return result;
}

/// In the order of the enumerators, as the dictionary names them.
constexpr std::array kStyles = {"elevation", "signed", "magnitude", "probability", "shaded_probability",
                                "count",     "mask",   "flags",     "classes"};
constexpr std::array kRules = {"mean", "extreme", "largest", "smallest", "any_bit"};

/// Throws std::logic_error for a name that is not there.
template <class Enum, std::size_t n>
Enum value_in(const std::array<const char*, n>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw std::logic_error("schemas/dictionary/layers.json: " + std::string(name));
  return static_cast<Enum>(found - names.begin());
}

/// "1" stands for no unit.
std::string shown_unit(std::string_view unit) {
  return unit == "1" ? "" : unit == "degree" ? "deg" : std::string(unit);
}

/// Empty for the styles after these, whose marks have their own colours.
std::string colors_of(Style style) {
  constexpr std::array kColors = {Colors::elevation, Colors::error,     Colors::magnitude,
                                  Colors::magnitude, Colors::magnitude, Colors::count};
  const auto index = static_cast<std::size_t>(style);
  return index < kColors.size() ? name_of(kColors.at(index)) : "";
}

OrderedJson classes_json(const std::vector<LayerClass>& classes) {
  OrderedJson list = OrderedJson::array();
  for (const LayerClass& c : classes)
    list.push_back({{"bits", c.bit},
                    {"text", c.text},
                    {"color", css_color(c.color)},
                    {"count", c.count},
                    {"is_mark", c.is_mark}});
  return list;
}

}  // namespace

std::int64_t reduction_factor(const GridSpec& spec, std::int64_t max_cells) {
  return std::max<std::int64_t>(1, (std::max(spec.rows, spec.cols) + max_cells - 1) / max_cells);
}

template <class T>
ReducedMap reduce(const Grid<T>& layer, std::int64_t factor, Rule rule) {
  const GridSpec& spec = layer.spec();
  ReducedMap map{factor, (spec.rows + factor - 1) / factor, (spec.cols + factor - 1) / factor, {}};
  map.cells.resize(static_cast<std::size_t>(map.rows * map.cols));
  by_rows(map.rows, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < map.cols; ++col)
      map.cells[static_cast<std::size_t>(row * map.cols + col)] =
          of_block(layer, {row * factor, col * factor}, factor, rule);
  });
  return map;
}

template ReducedMap reduce(const Grid<double>&, std::int64_t, Rule);
template ReducedMap reduce(const Grid<float>&, std::int64_t, Rule);
template ReducedMap reduce(const Grid<std::int32_t>&, std::int64_t, Rule);
template ReducedMap reduce(const Grid<std::int8_t>&, std::int64_t, Rule);

std::string css_color(std::uint32_t rrggbb) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%06x", static_cast<unsigned>(rrggbb));
  return text.data();
}

ReportLayer described(const char* file, const std::string& name) {
  const dictionary::Layer& words = dictionary::layer(file, name);
  ReportLayer layer{name, words.title, shown_unit(words.unit), value_in<Style>(kStyles, words.style),
                    value_in<Rule>(kRules, words.rule)};
  layer.quantity = words.quantity;
  layer.group = words.group;
  return layer;
}

template <class T>
ReportLayer reduced_layer(ReportLayer layer, const Grid<T>& grid, std::int64_t factor) {
  const std::vector<double> cells = reduce(grid, factor, layer.rule).cells;
  if (layer.style == Style::mask && layer.rule == Rule::mean && factor > 1)
    layer.values = quantise_shares(cells);
  else
    layer.values = is_whole(layer.style) ? quantise_whole(cells) : quantise(cells, steps_of(layer));
  return layer;
}

template ReportLayer reduced_layer(ReportLayer, const Grid<double>&, std::int64_t);
template ReportLayer reduced_layer(ReportLayer, const Grid<float>&, std::int64_t);
template ReportLayer reduced_layer(ReportLayer, const Grid<std::int32_t>&, std::int64_t);
template ReportLayer reduced_layer(ReportLayer, const Grid<std::int8_t>&, std::int64_t);

OrderedJson layer_json(const ReportLayer& layer, const std::string& id) {
  OrderedJson json = {{"id", id},
                      {"name", layer.name},
                      {"title", layer.title},
                      {"unit", layer.unit},
                      {"style", kStyles.at(static_cast<std::size_t>(layer.style))},
                      {"colors", colors_of(layer.style)},
                      {"limit", layer.limit ? OrderedJson(*layer.limit) : OrderedJson(nullptr)},
                      {"rule", kRules.at(static_cast<std::size_t>(layer.rule))},
                      {"offset", layer.values.offset},
                      {"step", layer.values.step},
                      {"low", layer.values.low},
                      {"high", layer.values.high}};
  if (!layer.group.empty()) json["group"] = layer.group;
  if (!layer.quantity.empty()) json["quantity"] = layer.quantity;
  if (!layer.classes.empty()) json["flags"] = classes_json(layer.classes);
  return json;
}

}  // namespace landfall::html_report
