// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/dictionary/layers.h"
#include "chain/draws/pass_rate.h"
#include "chain/evaluation/error_statistics.h"
#include "chain/evaluation/quantile/order_statistics.h"
#include "store/files/comparison_answer.h"
#include "store/files/contents.h"
#include "store/files/draws_file.h"
#include "store/files/field_json.h"
#include "store/files/file_description.h"
#include "store/files/grid_file.h"
#include "store/files/json_leaves.h"
#include "store/files/place_json.h"
#include "store/files/scan_likeness.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The configurations of all steps by tool; of several steps of one tool those that follow get a number.
std::vector<std::pair<std::string, OrderedJson>> configurations(const OrderedJson& description) {
  std::vector<std::pair<std::string, OrderedJson>> steps;
  std::map<std::string, int> count;
  const OrderedJson chain = description.value("chain", OrderedJson::array());
  for (const OrderedJson& step : chain) {
    const std::string tool = step.value("tool", "");
    const int number = ++count[tool];
    OrderedJson config = step.value("config", OrderedJson());
    if (step.contains("options") && step["options"].is_object()) config["--"] = step["options"];
    steps.emplace_back(number == 1 ? tool : tool + " " + std::to_string(number), std::move(config));
  }
  return steps;
}

OrderedJson config_of_step(const std::vector<std::pair<std::string, OrderedJson>>& steps,
                           const std::string& tool) {
  const auto found = std::ranges::find(steps, tool, &std::pair<std::string, OrderedJson>::first);
  return found == steps.end() ? OrderedJson() : found->second;
}

/// The keys that differ; a key that one of the files does not have has no value there.
OrderedJson configuration_json(const OrderedJson& a, const OrderedJson& b) {
  const auto steps_a = configurations(a);
  const auto steps_b = configurations(b);
  std::vector<std::string> tools;
  for (const auto& steps : {steps_a, steps_b})
    for (const auto& [tool, config] : steps)
      if (std::ranges::find(tools, tool) == tools.end()) tools.push_back(tool);
  OrderedJson differing = OrderedJson::array();
  for (const std::string& tool : tools) {
    for (const auto& [path, in_a, in_b] :
         value_pairs(config_of_step(steps_a, tool), config_of_step(steps_b, tool))) {
      if (in_a == in_b) continue;
      OrderedJson entry = {{"tool", tool}, {"key", path}};
      if (in_a) entry["a"] = *in_a;
      if (in_b) entry["b"] = *in_b;
      differing.push_back(std::move(entry));
    }
  }
  return differing;
}

/// The numbers of two objects side by side; arrays and texts are left out.
OrderedJson numbers_json(const OrderedJson& a, const OrderedJson& b) {
  const auto is_number = [](const std::optional<OrderedJson>& value) {
    return value && (value->is_number() || value->is_null());
  };
  OrderedJson numbers = OrderedJson::array();
  for (const auto& [path, in_a, in_b] : value_pairs(a, b)) {
    if (path == "version" || !(is_number(in_a) || is_number(in_b))) continue;
    const OrderedJson value_a = is_number(in_a) ? *in_a : OrderedJson();
    const OrderedJson value_b = is_number(in_b) ? *in_b : OrderedJson();
    OrderedJson entry = {{"metric", path}, {"a", value_a}, {"b", value_b}, {"difference", nullptr}};
    if (value_a.is_number() && value_b.is_number())
      entry["difference"] = value_b.get<double>() - value_a.get<double>();
    numbers.push_back(std::move(entry));
  }
  return numbers;
}

OrderedJson requirements_json(const OrderedJson& a, const OrderedJson& b) {
  OrderedJson all = OrderedJson::array();
  for (const char* const section : {"requirements", "own_requirements"}) {
    const OrderedJson in_a = a.value(section, OrderedJson::object());
    const OrderedJson in_b = b.value(section, OrderedJson::object());
    std::vector<std::string> names;
    for (const OrderedJson& side : {in_a, in_b})
      for (const auto& [name, requirement] : side.items())
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    for (const std::string& name : names)
      all.push_back(
          {{"name", name}, {"a", in_a.value(name, OrderedJson())}, {"b", in_b.value(name, OrderedJson())}});
  }
  return all;
}

/// The statistics of B - A where both have a value.
OrderedJson difference_json(const Grid<double>& a, const Grid<double>& b) {
  Grid<double> difference(a.spec(), std::numeric_limits<double>::quiet_NaN());
  std::int64_t only_a = 0;
  std::int64_t only_b = 0;
  std::optional<double> largest;
  for (std::size_t i = 0; i < a.spec().size(); ++i) {
    const bool in_a = std::isfinite(a.values()[i]);
    const bool in_b = std::isfinite(b.values()[i]);
    only_a += in_a && !in_b ? 1 : 0;
    only_b += in_b && !in_a ? 1 : 0;
    if (!in_a || !in_b) continue;
    difference.values()[i] = b.values()[i] - a.values()[i];
    largest = std::max(largest.value_or(0), std::abs(difference.values()[i]));
  }
  const ErrorStatistics statistics = error_statistics(difference, BinMask(a.spec(), 1));
  const auto quantile = [&](double q) {
    return or_null(quantile_of(
        a.spec().size(), [&](std::size_t i) { return difference.values()[i]; }, q));
  };
  return {{"valid_both", *statistics.count},
          {"only_a", only_a},
          {"only_b", only_b},
          {"mean", or_null(statistics.mean_m)},
          {"std", or_null(statistics.std_m)},
          {"nmad", or_null(statistics.nmad_m)},
          {"p05", quantile(0.05)},
          {"p50", or_null(statistics.median_m)},
          {"p95", quantile(0.95)},
          {"max_abs", or_null(largest)}};
}

/// Classes, whose differences mean nothing, are counted where they differ.
OrderedJson class_json(const Grid<double>& a, const Grid<double>& b) {
  std::int64_t differing = 0;
  for (std::size_t i = 0; i < a.spec().size(); ++i) differing += a.values()[i] != b.values()[i] ? 1 : 0;
  return {{"bins", a.spec().size()}, {"differing", differing}};
}

/// The bins that two grids have in common.
GridSpec common_bins(const GridSpec& a, const GridSpec& b) {
  const auto overlap = [](std::int64_t first_a, std::int64_t count_a, std::int64_t first_b,
                          std::int64_t count_b) {
    const std::int64_t first = std::max(first_a, first_b);
    return std::pair(first,
                     std::max<std::int64_t>(0, std::min(first_a + count_a, first_b + count_b) - first));
  };
  GridSpec common = a;
  std::tie(common.first_row, common.rows) = overlap(a.first_row, a.rows, b.first_row, b.rows);
  std::tie(common.first_col, common.cols) = overlap(a.first_col, a.cols, b.first_col, b.cols);
  return common;
}

/// A layer on the common bins; `raise` is added to it.
Grid<double> on_bins(Grid<double> layer, const GridSpec& placed, const GridSpec& common, double raise) {
  if (raise != 0)
    for (double& value : layer.values()) value += raise;
  if (placed == common) return layer;
  Grid<double> part(common);
  for (std::int64_t row = 0; row < common.rows; ++row) {
    const auto from = layer.row(row + common.first_row - placed.first_row)
                          .subspan(static_cast<std::size_t>(common.first_col - placed.first_col));
    std::ranges::copy_n(from.begin(), common.cols, part.row(row).begin());
  }
  return part;
}

/// The change of a layer of coordinates when its map is placed in another frame.
double shift_of(const std::string& kind, const std::string& layer, const Placement& placement) {
  const dictionary::Layer* const words = dictionary::find_layer(kind, layer);
  const std::string_view axis = words == nullptr ? "" : words->axis;
  return axis.empty() ? 0 : placement.shift_m()[static_cast<std::size_t>(axis[0] - 'x')];
}

/// Two grids, the second placed in the frame of the first.
class GridPair {
 public:
  GridPair(const LandfallFileReader& a, const LandfallFileReader& b, const MeetingRules& rules)
      : file_a_(a), file_b_(b), grid_a_(a), grid_b_(b) {
    meeting_ = meeting_of(meeting_kind("compared"), {a.name(), grid_a_.crs_wkt()},
                          {b.name(), grid_b_.crs_wkt()}, rules);
    const auto placed = placed_grid(grid_b_.spec(), grid_a_.spec(), meeting_.placement);
    placed_b_ = placed.value_or(grid_b_.spec());
    common_ = common_bins(grid_a_.spec(), placed_b_);
    if (!meeting_.refusal.empty())
      reason_ = meeting_.refusal;
    else if (!placed && grid_a_.spec().resolution_m != grid_b_.spec().resolution_m)
      reason_ = "the bins of " + b.name() + " have another size";
    else if (!placed)
      reason_ = "the bins of " + b.name() + " fall between those of " + a.name();
    else if (common_.size() == 0)
      reason_ = "the maps have no bin in common";
  }

  /// Adds the places, the common bins and, with statistics, the layers, or why there are none.
  void add_to(OrderedJson& json, const std::string& kind, const ComparisonRequest& request,
              const ProgressCallback& progress) const {
    json["a"]["place"] = place_json(grid_a_.crs_wkt());
    json["b"]["place"] = place_json(grid_b_.crs_wkt());
    json["placement"] = {{"shift_m", meeting_.placement.shift_m()}, {"said", meeting_.said}};
    json["same_grid"] = reason_.empty() && placed_b_ == grid_a_.spec();
    if (!reason_.empty()) {
      json["not_compared"] = reason_;
      return;
    }
    json["common_bins"] = {{"rows", common_.rows},
                           {"columns", common_.cols},
                           {"first_in_a", first_in(grid_a_.spec())},
                           {"first_in_b", first_in(placed_b_)},
                           {"x_m", {common_.x(0), common_.x(common_.cols - 1)}},
                           {"y_m", {common_.y(0), common_.y(common_.rows - 1)}}};
    if (!request.statistics) return;
    add_layers(json, kind, request, progress);
    if (kind == "dem") json["elevation_errors"] = elevation_errors();
  }

 private:
  /// Row and column of the first common bin in a grid.
  [[nodiscard]] OrderedJson first_in(const GridSpec& grid) const {
    return {common_.first_row - grid.first_row, common_.first_col - grid.first_col};
  }
  /// The layers of A and of B on the common bins, B in the frame of A.
  [[nodiscard]] std::pair<Grid<double>, Grid<double>> read(const std::string& kind,
                                                           const std::string& layer) const {
    return {
        on_bins(grid_a_.read<double>(layer), grid_a_.spec(), common_, 0),
        on_bins(grid_b_.read<double>(layer), placed_b_, common_, shift_of(kind, layer, meeting_.placement))};
  }
  /// The errors of both DEMs on the bins that have an elevation and a truth in both.
  [[nodiscard]] OrderedJson elevation_errors() const {
    auto [a, b] = read("dem", "z_est");
    const auto empty = [](const Grid<double>& z) {
      return std::ranges::count_if(z.values(), [](double value) { return std::isnan(value); });
    };
    OrderedJson json = {
        {"empty_a", empty(a)}, {"empty_b", empty(b)}, {"rms_a_m", nullptr}, {"rms_b_m", nullptr}};
    if (!grid_a_.has("z_true") || !grid_b_.has("z_true")) return json;
    const auto [true_a, true_b] = read("dem", "z_true");
    double sum_a = 0, sum_b = 0, count = 0;
    for (std::size_t i = 0; i < common_.size(); ++i) {
      const double error_a = true_a.values()[i] - a.values()[i];
      const double error_b = true_b.values()[i] - b.values()[i];
      if (!std::isfinite(error_a) || !std::isfinite(error_b)) continue;
      sum_a += error_a * error_a;
      sum_b += error_b * error_b;
      ++count;
    }
    if (count == 0) return json;
    json["rms_a_m"] = std::sqrt(sum_a / count);
    json["rms_b_m"] = std::sqrt(sum_b / count);
    return json;
  }
  void add_layers(OrderedJson& json, const std::string& kind, const ComparisonRequest& request,
                  const ProgressCallback& progress) const {
    json["layers"] = OrderedJson::array();
    const std::vector<ContentInfo> layers = layers_of(file_a_, grid_a_.spec());
    const std::vector<ContentInfo> others = layers_of(file_b_, grid_b_.spec());
    std::size_t done = 0;
    for (const ContentInfo& layer : layers) {
      report(progress, static_cast<double>(done++) / static_cast<double>(layers.size()));
      if (std::ranges::find(others, layer.name, &ContentInfo::name) == others.end()) continue;
      const auto [a, b] = read(kind, layer.name);
      if (request.on_layer) request.on_layer(kind, layer, a, b);
      OrderedJson entry = {{"layer", layer.name}, {"unit", layer.units}};
      entry.update(is_class(layer) ? class_json(a, b) : difference_json(a, b));
      json["layers"].push_back(std::move(entry));
    }
  }

  const LandfallFileReader& file_a_;
  const LandfallFileReader& file_b_;
  GridLayerReader grid_a_, grid_b_;
  Meeting meeting_;
  GridSpec placed_b_, common_;
  std::string reason_;  ///< why no bins are compared; empty if they are
};

/// NaN is a draw that is not judged, of which no pair is made.
OrderedJson pair_json(const std::string& name, std::vector<double> a, std::vector<double> b) {
  std::size_t judged = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!std::isnan(a[i]) && !std::isnan(b[i]))
      std::tie(a[judged], b[judged]) = std::pair(a[i], b[i]), ++judged;
  const auto not_judged = static_cast<std::int64_t>(a.size() - judged);
  a.resize(judged);
  b.resize(judged);
  const PairedCounts counts = paired_counts(b, a);  // the difference is B - A
  const ProbabilityDifference difference = newcombe_difference(counts);
  return {{"name", name},
          {"both", counts.both},
          {"only_a", counts.only_b},
          {"only_b", counts.only_a},
          {"neither", counts.neither},
          {"not_judged", not_judged},
          {"mcnemar_p", mcnemar_p(counts)},
          {"difference", {{"value", difference.value}, {"low", difference.low}, {"high", difference.high}}}};
}

/// The outcomes of draws that can be paired, by name: 1, 0, and NaN where not judged.
std::vector<std::pair<std::string, std::vector<double>>> outcomes(const DrawTable& table) {
  std::vector<std::pair<std::string, std::vector<double>>> all;
  for (const dictionary::Requirement& words : dictionary::kRequirements)
    all.emplace_back(words.name, pass_column(table, words.name).values);
  for (const OwnColumn& own : own_columns(table)) all.emplace_back(own.name, own.passes->values);
  all.emplace_back("all", std::vector<double>(table.pass.begin(), table.pass.end()));
  std::ranges::replace(all.back().second, static_cast<double>(pass_flag(std::nullopt)),
                       std::numeric_limits<double>::quiet_NaN());
  for (const char* const name : {"site.true_safe", "landing.safe", "blind.safe"})
    if (const DrawColumn* const column = find_metric(table, name)) {
      all.emplace_back(name, column->values);
      std::ranges::replace_if(
          all.back().second, [](double safe) { return std::isnan(safe); }, 0);  // no site
    }
  return all;
}

/// Draws with the same random numbers, over scans of one number.
struct DrawPairs {
  std::vector<std::size_t> rows_a, rows_b;  ///< in the order of A
};

DrawPairs draws_in_common(const DrawTable& a, const DrawTable& b) {
  const auto keys_of = [](const DrawTable& table) {
    const auto pair = std::ranges::find(table.varied, kPairColumn, &DrawColumn::name);
    std::vector<std::tuple<double, std::int64_t, std::int64_t>> keys;
    for (std::size_t i = 0; i < table.seeds.size(); ++i)
      keys.emplace_back(pair == table.varied.end() ? 0 : pair->values[i], table.seeds[i], table.draws[i]);
    return keys;
  };
  const auto keys_a = keys_of(a);
  const auto keys_b = keys_of(b);
  std::map<std::tuple<double, std::int64_t, std::int64_t>, std::size_t> row_of;
  for (std::size_t i = 0; i < keys_b.size(); ++i) row_of.emplace(keys_b[i], i);
  DrawPairs pairs;
  for (std::size_t i = 0; i < keys_a.size(); ++i)
    if (const auto found = row_of.find(keys_a[i]); found != row_of.end()) {
      pairs.rows_a.push_back(i);
      pairs.rows_b.push_back(found->second);
    }
  return pairs;
}

std::vector<double> rows_of(const std::vector<double>& values, const std::vector<std::size_t>& rows) {
  return mapped(rows, [&](std::size_t row) { return values[row]; });
}

void add_draws(OrderedJson& json, const std::filesystem::path& a, const std::filesystem::path& b) {
  const DrawTable table_a = read_draws(a).draws.table;
  const DrawTable table_b = read_draws(b).draws.table;
  const DrawPairs common = draws_in_common(table_a, table_b);
  json["draws"] = {{"a", table_a.size()}, {"b", table_b.size()}, {"common", common.rows_a.size()}};
  if (common.rows_a.empty()) return;
  json["differing_keys"] = OrderedJson::array();
  for (const DrawColumn& column : table_a.varied) {
    const auto other = std::ranges::find(table_b.varied, column.name, &DrawColumn::name);
    if (other != table_b.varied.end() &&
        rows_of(column.values, common.rows_a) != rows_of(other->values, common.rows_b))
      json["differing_keys"].push_back(column.name);
  }
  json["pairs"] = OrderedJson::array();
  const auto outcomes_b = outcomes(table_b);
  for (const auto& [name, values] : outcomes(table_a)) {
    const auto other = std::ranges::find(outcomes_b, name, [](const auto& outcome) { return outcome.first; });
    if (other != outcomes_b.end())
      json["pairs"].push_back(
          pair_json(name, rows_of(values, common.rows_a), rows_of(other->second, common.rows_b)));
  }
}

}  // namespace

OrderedJson compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                          const ComparisonRequest& request, const ProgressCallback& progress) {
  const OrderedJson of_a = describe_file(a, {.statistics = false});
  const OrderedJson of_b = describe_file(b, {.statistics = false});
  if (of_a["kind"] != of_b["kind"])
    throw UsageError("--compare needs two files of one kind; " + a.string() + ": " +
                     of_a["kind"].get<std::string>() + ", " + b.string() + ": " +
                     of_b["kind"].get<std::string>());
  OrderedJson json = {{"kind", of_a["kind"]},
                      {"a", {{"file", a.string()}, {"file_id", of_a["file_id"]}}},
                      {"b", {{"file", b.string()}, {"file_id", of_b["file_id"]}}},
                      {"same_file_id", of_a["file_id"] == of_b["file_id"]},
                      {"configuration", configuration_json(of_a, of_b)}};
  for (const char* const part : {"scan", "metrics", "score", "plan"}) {
    if (!of_a.contains(part) || !of_b.contains(part)) continue;
    const OrderedJson requirements = requirements_json(of_a[part], of_b[part]);
    if (!requirements.empty()) json["requirements"] = requirements;
    json["metrics"] = numbers_json(of_a[part], of_b[part]);
  }
  if (of_a["kind"] == "draws") {
    json["metrics"] = numbers_json(of_a["verdict"], of_b["verdict"]);
    add_draws(json, a, b);
  }
  const LandfallFileReader file_a(a, kLandfallKinds);
  const LandfallFileReader file_b(b, kLandfallKinds);
  if (has_grid(file_a) && has_grid(file_b))
    GridPair(file_a, file_b, request.rules).add_to(json, json["kind"].get<std::string>(), request, progress);
  json["answer"] = answer_of(json, of_a, of_b);
  if (json["kind"] == "scan") add_likeness(json, a, b, request, progress);
  return json;
}

}  // namespace landfall
