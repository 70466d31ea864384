// SPDX-License-Identifier: GPL-3.0-or-later
// Maps of probabilities show the shaded terrain where the probability is 0, and colours from 0 to the
// largest one elsewhere, because most places never fail, and a colour for 0 would hide where the others
// lie. Blocks of bins have their largest probability. The report keeps the commands of the chain for each
// draw: they carry the configurations, so that they need no file but the scan and the terrain.
#include "app/report/draws_page.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "app/report/escape.h"
#include "app/report/hazard_page.h"
#include "app/report/heading.h"
#include "app/report/page_parts.h"
#include "app/report/verdicts.h"
#include "base/dictionary/tables/requirements.h"
#include "base/text/number_text.h"
#include "base/text/split_text.h"
#include "chain/draws/draw_layers.h"
#include "store/config/hazard_config.h"
#include "store/files/field_json.h"

namespace landfall::html_report {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The layers in the order of the page.
class DrawsLayers {
 public:
  DrawsLayers(const Draws& draws, std::int64_t factor, Packer& packer)
      : draws_(draws), maps_(*draws.maps), factor_(factor), packer_(packer) {}

  [[nodiscard]] OrderedJson all() {
    if (draws_.map_truth) add("z_true_map", *draws_.map_truth);
    add("in_region", *draws_.region);
    add("p_invalid", share_of_draws(maps_.invalid, maps_.draws, nullptr));
    const auto [x, y, z, absolute] = failure_maps(maps_);
    for (const FailureMap& map : {z, x, y, absolute})
      if (const std::int64_t judged = judged_draws(draws_.table, map.requirement); judged > 0)
        add(map.layer, share_of_draws(map.count, judged, &*draws_.region));
    if (maps_.safety) add_safety(*maps_.safety);
    add("e_z_mean", mean_of(maps_.e_z));
    add("e_z_std", std_of(maps_.e_z));
    if (maps_.e_map) add("e_map_std", std_of(*maps_.e_map));
    if (draws_.predicted_sigma) add_predicted(*draws_.predicted_sigma);
    return std::move(list_);
  }

 private:
  template <class T>
  void add(const std::string& name, const Grid<T>& values) {
    list_.push_back(packer_.keep(reduced_layer(described("draws", name), values, factor_), name));
  }

  void add_safety(const SafetyCounts& safety) {
    add("p_missed_hazard", share_of_known(safety, safety.missed));
    add("p_judged_safe", share_of_known(safety, safety.judged_safe));
  }

  void add_predicted(const Grid<float>& sigma_m) {
    add("z_sigma_abs", sigma_m);
    add("e_map_std_over_sigma", std_over_sigma(*maps_.e_map, sigma_m));
  }

  const Draws& draws_;
  const DrawMaps& maps_;
  std::int64_t factor_;
  Packer& packer_;
  OrderedJson list_ = OrderedJson::array();
};

OrderedJson values_json(const DrawColumn& column, std::int64_t shown) {
  OrderedJson values = OrderedJson::array();
  for (std::int64_t i = 0; i < shown; ++i)
    values.push_back(finite_json(column.values[static_cast<std::size_t>(i)]));
  return {{"name", column.name}, {"values", std::move(values)}};
}

std::string unit_name(const std::string& unit) { return unit == "fraction" ? "frac" : unit; }

/// A requirement whose columns begin with `path`.
OrderedJson requirement_json(const DrawTable& table, const std::string& path, const std::string& name,
                             std::int64_t shown) {
  OrderedJson requirement = values_json(*find_metric(table, path + ".value"), shown);
  requirement["name"] = name;
  requirement["limits"] = values_json(*find_metric(table, path + ".limit"), shown)["values"];
  requirement["pass"] = values_json(*find_metric(table, path + ".pass"), shown)["values"];
  return requirement;
}

/// The metric of one of the user's own requirements, in the configuration of the run of draws.
std::string own_metric(const OwnColumn& own, const nlohmann::json& config) {
  const char* const stage = own.path.starts_with("score.") ? "hazard" : "eval";
  for (const nlohmann::json& each : config.at(stage).at("requirements"))
    if (each.at("name") == own.name) return each.at("metric");
  throw std::out_of_range(own.path);
}

/// "m", "frac", "bins" or, for other numbers, "".
std::string unit_of_metric(const std::string& metric) {
  for (const char* const unit : {"m", "frac", "bins"})
    if (metric.ends_with(std::string("_") + unit)) return unit;
  return "";
}

/// The largest of some metrics in each draw.
std::optional<DrawColumn> largest_of(const DrawTable& table, const std::vector<std::string>& metrics) {
  std::optional<DrawColumn> largest;
  for (const std::string& metric : metrics) {
    const DrawColumn* const column = find_metric(table, metric);
    if (column == nullptr) return std::nullopt;
    if (!largest) largest = *column;
    for (std::size_t i = 0; i < column->values.size(); ++i)
      largest->values[i] = std::fmax(largest->values[i], column->values[i]);
  }
  return largest;
}

/// The length that decides a requirement, in each draw, and its limit: a passing count of 0 footprints shows
/// no margin. Null for a requirement without one, for draws that keep only the counts, and where the limit
/// varies.
OrderedJson deciding_json(const DrawTable& table, const dictionary::Requirement& words,
                          const nlohmann::json& limits, std::int64_t shown) {
  const std::string limit = words.worst_limit;
  const std::vector<std::string> worst = split_words(words.worst);
  const bool varies = std::ranges::any_of(
      table.varied, [&](const DrawColumn& key) { return key.name == "eval.limits." + limit; });
  if (!limit.ends_with("_m") || varies || !limits.contains(limit)) return nullptr;
  const std::optional<DrawColumn> largest = largest_of(table, worst);
  if (!largest) return nullptr;
  return {
      {"values", values_json(*largest, shown)["values"]}, {"limit", limits.at(limit)}, {"metrics", worst}};
}

OrderedJson requirements_json(const DrawTable& table, const nlohmann::json& config, std::int64_t shown) {
  OrderedJson list = OrderedJson::array();
  for (const dictionary::Requirement& words : dictionary::kRequirements) {
    OrderedJson requirement =
        requirement_json(table, "requirements." + std::string(words.name), words.name, shown);
    requirement["measured"] = words.measured;
    requirement["unit"] = unit_name(words.unit);
    requirement["at_least"] = words.at_least;
    const nlohmann::json limits = config.at("eval").value("limits", nlohmann::json::object());
    requirement["deciding"] = deciding_json(table, words, limits, shown);
    list.push_back(std::move(requirement));
  }
  for (const OwnColumn& own : own_columns(table)) {
    OrderedJson requirement = requirement_json(table, own.path, own.name, shown);
    const std::string metric = own_metric(own, config);
    requirement["measured"] = metric;
    requirement["unit"] = unit_of_metric(metric);
    requirement["at_least"] = find_metric(table, own.path + ".at_least")->values.front() == 1;
    list.push_back(std::move(requirement));
  }
  return list;
}

/// A metric with at least two values in the draws; NaN is none.
bool is_shown(const DrawColumn& column) {
  for (const char* const begin : {"requirements.", "own_requirements.", "score.own_requirements."})
    if (column.name.starts_with(begin)) return false;
  const auto is_value = [](double value) { return std::isfinite(value); };
  const auto first = std::ranges::find_if(column.values, is_value);
  return std::any_of(first, column.values.end(),
                     [&](double value) { return is_value(value) && value != *first; });
}

OrderedJson columns_json(const std::vector<DrawColumn>& columns, std::int64_t shown, const auto& keep) {
  OrderedJson list = OrderedJson::array();
  for (const DrawColumn& column : columns)
    if (keep(column)) list.push_back(values_json(column, shown));
  return list;
}

/// The configurations of the chain; none where each scan has its own.
OrderedJson stages_json(const nlohmann::json& config) {
  if (!config.at("scan").contains("detector")) return nullptr;
  OrderedJson stages = {
      {"scan", config.at("scan")}, {"regrid", config.at("regrid")}, {"eval", config.at("eval")}};
  for (const char* const stage : {"hazard", "terrain"})
    if (config.contains(stage) && !config.at(stage).is_null()) stages[stage] = config.at(stage);
  return stages;
}

/// The touchdowns of both arms; none of a run whose draws do not land.
OrderedJson landings_json(const DrawTable& table, std::int64_t shown) {
  if (find_metric(table, kLandingSafe) == nullptr) return nullptr;
  OrderedJson arms;
  for (const char* const arm : {"landing", "blind"})
    for (const char* const key : {"x_m", "y_m", "slope_deg", "roughness_m", "safe"})
      arms[arm][key] = values_json(*find_metric(table, std::string(arm) + "." + key), shown)["values"];
  return arms;
}

/// The border of the reachable places; null where they are the circle of the divert radius.
OrderedJson reach_json(const nlohmann::json& config) {
  if (!config.contains("hazard") || config.at("hazard").is_null()) return nullptr;
  const SiteParameters sites = hazard_config(config.at("hazard")).sites;
  return sites.reach ? outline_json(*sites.reach) : OrderedJson(nullptr);
}

/// The assumptions of the draws; those that the metrics have are means over the draws.
std::string assumptions_of(const Draws& draws) {
  if (!draws.footprint_bins) return "";
  const auto mean = [&](const std::string& name) -> std::optional<double> {
    const DrawColumn* const column = find_metric(draws.table, "assumptions." + name);
    if (column == nullptr || column->values.empty()) return std::nullopt;
    const double sum = std::accumulate(column->values.begin(), column->values.end(), 0.0);
    return std::isfinite(sum) ? std::optional(sum / static_cast<double>(column->values.size()))
                              : std::nullopt;
  };
  return assumptions_html({*draws.footprint_bins, mean("truth_spacing_m"), mean("median_returns_per_bin"),
                           mean("single_return_frac")});
}

/// The maps, if the run of draws has any, and the numbers of each draw. `config` is the run's configuration.
ReportData draws_data(const DrawsReport& content, const nlohmann::json& config) {
  const DrawTable& table = content.draws.table;
  const EvaluationParameters& parameters = content.parameters;
  const std::int64_t shown = std::min(table.size(), kMaxShownDraws);
  Packer packer;
  ReportData data;
  data.values = {{"colors", colors_json()},
                 {"quantile", parameters.quantile},
                 {"region", region_json(parameters.region_shape, parameters.region_radius_m,
                                        parameters.region_center_m, parameters.region_half_width_m)},
                 {"layers", OrderedJson::array()},
                 {"groups", groups_json("draws")},
                 {"draw_count", table.size()},
                 {"first_draw", table.first},
                 {"numbers", std::vector<std::int64_t>(table.draws.begin(), table.draws.begin() + shown)},
                 {"pass", std::vector<int>(table.pass.begin(), table.pass.begin() + shown)},
                 {"requirements", requirements_json(table, config, shown)},
                 {"varied", columns_json(table.varied, shown, [](const DrawColumn&) { return true; })},
                 {"metrics", columns_json(table.metrics, shown, is_shown)},
                 {"stages", stages_json(config)},
                 {"traces", content.traces},
                 {"terrain_seeds", config.value("terrain_seed", "fixed")},
                 {"uncertainty", config.value("uncertainty", false)},
                 {"landings", landings_json(table, shown)},
                 {"reach", reach_json(config)}};
  if (content.draws.maps) {
    const GridSpec& spec = content.draws.maps->spec();
    const std::int64_t factor = reduction_factor(spec, kMaxCells);
    data.values["grid"] = grid_json(spec, factor);
    data.values["footprint"] = {
        {"shape", parameters.footprint_shape == FootprintShape::square ? "square" : "disc"},
        {"text", "footprint"},
        {"width_m", parameters.footprint_m},
        {"half_bins", footprint_of(parameters, spec.resolution_m).half_bins()}};
    data.values["layers"] = DrawsLayers(content.draws, factor, packer).all();
  }
  data.packed = packer.pack();
  return data;
}

std::string number_cell(const std::string& text) { return "<td class=\"number\">" + text + "</td>"; }

std::string rate_row_html(const std::string& name, const OrderedJson& rate, bool is_stopped) {
  const auto passed = rate.at("passed").get<std::int64_t>();
  const auto draws = rate.at("draws").get<std::int64_t>();
  const std::string note = is_stopped ? "<span class=\"note\"> not valid after stopping</span>" : "";
  return "<tr data-requirement=\"" + name + "\"><th scope=\"row\">" +
         (name == "all"                 ? "all six"
          : name == "all_and_own"       ? "all six and own"
          : name == "chosen_place_safe" ? "chosen place truly safe"
          : name == "landing_safe"      ? "safe landing with the lidar"
          : name == "blind_safe"        ? "safe landing without a lidar"
                                        : name) +
         "</th>" + number_cell(grouped(passed) + " of " + grouped(draws)) +
         (rate.value("judged", draws) == 0
              ? "<td colspan=\"3\"><span class=\"verdict unjudged\">not judged</span></td></tr>\n"
              : number_cell(percent_text(static_cast<double>(passed) / static_cast<double>(draws))) +
                    number_cell(probability_text(rate.at("wilson_low")) + " \u2026 " +
                                probability_text(rate.at("wilson_high")) + note) +
                    number_cell(probability_text(rate.at("exact_lower_bound")) + note) + "</tr>\n");
}

std::string rates_html(const OrderedJson& verdict) {
  std::string text =
      "<table id=\"rates\"><thead><tr><th>requirement</th><th class=\"number\">passed</th><th "
      "class=\"number\">share"
      "</th><th class=\"number\">Wilson interval, 95 %</th><th class=\"number\">probability at least, 95 "
      "%</th></tr>"
      "</thead><tbody>\n";
  const auto rows = [&](const OrderedJson& result) {
    const bool is_stopped = verdict.contains("sprt");
    for (const OrderedJson& rate : result.at("rates"))
      text += rate_row_html(rate.at("requirement"), rate, is_stopped);
    if (result.contains("hazard"))
      text += rate_row_html("chosen_place_safe", result.at("hazard").at("chosen_place_safe"), is_stopped);
    if (!result.contains("landing")) return;
    text += rate_row_html("landing_safe", result.at("landing").at("safe"), is_stopped);
    text += rate_row_html("blind_safe", result.at("landing").at("blind"), is_stopped);
  };
  const auto heading = [&](const std::string& of) {
    text += "<tr><th colspan=\"5\" scope=\"rowgroup\">" + of + "</th></tr>\n";
  };
  if (verdict.contains("pairs")) {
    for (const OrderedJson& pair : verdict.at("pairs")) {
      heading("pair " + std::to_string(pair.at("pair").get<int>()));
      rows(pair);
    }
    heading("all pairs, for these terrains");
  }
  rows(verdict);
  return text + "</tbody></table>\n";
}

std::string banner_html(const OrderedJson& verdict) {
  const OrderedJson& all = verdict.at("rates").back();
  const bool all_pass = all.at("passed") == all.at("draws");
  std::string text = grouped(all.at("passed").get<std::int64_t>()) + " of " +
                     grouped(all.at("draws").get<std::int64_t>()) + " draws pass all requirements";
  std::string kind = all_pass ? "pass" : "fail";
  if (all.value("judged", all.at("draws").get<std::int64_t>()) == 0) {
    text += ": not judged, because the footprint has too few bins";
    kind = "unjudged";
  } else if (verdict.contains("sprt")) {
    const auto state = verdict.at("sprt").get<std::string>();
    text += "; sequential test: " + state;
    kind = state == "accepted" ? "pass" : state == "rejected" ? "fail" : "unjudged";
  } else if (all.at("passed") == 0) {
    text += ": the probability of passing is at most " + probability_text(all.at("wilson_high")) +
            " (Wilson, 95 %)";
  } else {
    text += ": the probability of passing is at least " + probability_text(all.at("exact_lower_bound")) +
            " (95 %)";
  }
  return "<div class=\"banner " + kind + "\" id=\"verdict\">" + text + "</div>";
}

}  // namespace

std::string draws_page(const DrawsReport& content, const Provenance& provenance, const std::string& title) {
  nlohmann::json steps = provenance.chain;
  steps.push_back(provenance.as_step());
  return page_html("draws.html", {{"title", html_text(title.empty() ? title_of(steps, "Draws") : title)},
                                  {"subtitle", subtitle_html(steps, "draws", "scan", "scan")},
                                  {"banner", banner_html(content.verdict)},
                                  {"rates", rates_html(content.verdict)},
                                  {"assumptions", assumptions_of(content.draws)},
                                  {"provenance", provenance_html(steps, "these draws")},
                                  {"data", data_html(draws_data(content, provenance.config))}});
}

}  // namespace landfall::html_report
