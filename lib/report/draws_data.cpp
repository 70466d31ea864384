// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/draws_data.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "evaluation/piecewise.h"

namespace landfall::html_report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

Grid<float> layer_of(const GridSpec& spec, const auto& value) {
  auto layer = Grid<float>::unset(spec);
  for_each_index(spec.size(), [&](std::size_t i) { layer.values()[i] = static_cast<float>(value(i)); });
  return layer;
}

/// The layers in the order of the page.
class CampaignLayers {
 public:
  CampaignLayers(const Draws& draws, std::int64_t factor, Packer& packer)
      : draws_(draws), maps_(*draws.maps), factor_(factor), packer_(packer) {}

  [[nodiscard]] Json all() {
    add({"z_true_map", "True elevation", "m"}, *draws_.z_true_map);
    add({"in_region", "Judged region", "", Style::mask, Rule::largest}, *draws_.region);
    add_probability("p_invalid", "Empty bin", maps_.invalid, false);
    const std::string footprint = "Footprint fails: ";
    add_probability("p_fail_rel_z", footprint + "relative z", maps_.fail_rel_z, true);
    add_probability("p_fail_rel_x", footprint + "relative x", maps_.fail_rel_x, true);
    add_probability("p_fail_rel_y", footprint + "relative y", maps_.fail_rel_y, true);
    add_probability("p_fail_absolute", footprint + "absolute", maps_.fail_absolute, true);
    if (maps_.safety) add_safety(*maps_.safety);
    add_error("e_z_mean", "Mean error in z", Style::signed_error, Rule::extreme, "mean of e_z",
              [&](std::size_t i) { return maps_.e_z.mean_m(i); });
    add_error("e_z_std", "Spread of the error in z", Style::magnitude, Rule::largest,
              "standard deviation of e_z", [&](std::size_t i) { return maps_.e_z.std_m(i); });
    add_error("e_map_std", "Spread of the error of the map", Style::magnitude, Rule::mean,
              "standard deviation", [&](std::size_t i) { return maps_.e_map.std_m(i); });
    if (draws_.z_sigma_abs) add_predicted(*draws_.z_sigma_abs);
    return std::move(list_);
  }

 private:
  template <class T>
  void add(ReportLayer layer, const Grid<T>& values) {
    const std::string id = layer.name;
    list_.push_back(packer_.keep(reduced_layer(std::move(layer), values, factor_), id));
  }

  void add_probability(const std::string& name, const std::string& title, const Grid<std::int32_t>& count,
                       bool in_region) {
    ReportLayer layer{name, title, "", Style::chance, Rule::largest};
    layer.quantity = "share of the draws";
    const auto n = static_cast<double>(maps_.draws);
    add(std::move(layer), layer_of(maps_.spec(), [&](std::size_t i) {
          return in_region && draws_.region->values()[i] == 0 ? kNoValue : count.values()[i] / n;
        }));
  }

  void add_error(const std::string& name, const std::string& title, Style style, Rule rule,
                 const std::string& quantity, const auto& value) {
    ReportLayer layer{name, title, "m", style, rule};
    layer.quantity = quantity;
    add(std::move(layer), layer_of(maps_.spec(), value));
  }

  /// Of the draws in which map and truth know the place.
  void add_safety(const SafetyCounts& safety) {
    const auto add_share = [&](const std::string& name, const std::string& title, const Grid<std::int32_t>& count) {
      ReportLayer layer{name, title, "", Style::chance, Rule::largest};
      layer.quantity = "share of the draws";
      add(std::move(layer), layer_of(maps_.spec(), [&](std::size_t i) {
            const std::int32_t known = safety.known.values()[i];
            return known > 0 ? static_cast<double>(count.values()[i]) / known : kNoValue;
          }));
    };
    add_share("p_missed_hazard", "Missed hazard", safety.missed);
    add_share("p_judged_safe", "Judged safe", safety.judged_safe);
  }

  void add_predicted(const Grid<float>& sigma_m) {
    ReportLayer layer{"z_sigma_abs", "Predicted spread", "m", Style::magnitude, Rule::mean};
    layer.quantity = "standard deviation";
    add(std::move(layer), sigma_m);
    ReportLayer ratio{"e_map_std_over_sigma", "Observed over predicted", "", Style::magnitude, Rule::mean};
    ratio.quantity = "e_map_std / z_sigma_abs";
    add(std::move(ratio), layer_of(maps_.spec(), [&](std::size_t i) {
          const double predicted_m = sigma_m.values()[i];
          return predicted_m > 0 ? maps_.e_map.std_m(i) / predicted_m : kNoValue;
        }));
  }

  const Draws& draws_;
  const DrawMaps& maps_;
  std::int64_t factor_;
  Packer& packer_;
  Json list_ = Json::array();
};

Json values_json(const DrawColumn& column, std::int64_t shown) {
  Json values = Json::array();
  for (std::int64_t i = 0; i < shown; ++i)
    values.push_back(finite_json(column.values[static_cast<std::size_t>(i)]));
  return {{"name", column.name}, {"values", std::move(values)}};
}

const DrawColumn& column_of(const DrawTable& table, const std::string& name) {
  return *std::ranges::find(table.metrics, name, &DrawColumn::name);
}

const char* unit_name(RequirementUnit unit) {
  return unit == RequirementUnit::fraction ? "frac" : unit == RequirementUnit::bins ? "bins" : "footprints";
}

Json requirements_json(const DrawTable& table, std::int64_t shown) {
  Json list = Json::array();
  for (const RequirementInfo& info : kRequirementInfo) {
    const std::string path = "requirements." + std::string(info.name) + ".";
    Json requirement = values_json(column_of(table, path + "value"), shown);
    requirement["name"] = info.name;
    requirement["measured"] = info.measured;
    requirement["unit"] = unit_name(info.unit);
    requirement["at_least"] = info.at_least;
    requirement["limits"] = values_json(column_of(table, path + "limit"), shown)["values"];
    requirement["pass"] = values_json(column_of(table, path + "pass"), shown)["values"];
    list.push_back(std::move(requirement));
  }
  return list;
}

bool is_shown(const DrawColumn& column) {
  if (column.name.starts_with("requirements.")) return false;
  return std::ranges::any_of(column.values, [&](double value) { return value != column.values.front(); });
}

Json columns_json(const std::vector<DrawColumn>& columns, std::int64_t shown, const auto& keep) {
  Json list = Json::array();
  for (const DrawColumn& column : columns)
    if (keep(column)) list.push_back(values_json(column, shown));
  return list;
}

/// 64 bits, which a number of a script cannot hold.
Json seeds_json(const DrawTable& table, std::int64_t shown) {
  Json seeds = Json::array();
  for (std::int64_t i = 0; i < shown; ++i)
    seeds.push_back(std::to_string(table.seeds[static_cast<std::size_t>(i)]));
  return seeds;
}

/// The configurations of the chain; none where each scan has its own.
Json stages_json(const nlohmann::json& config) {
  if (!config.at("scan").contains("detector")) return nullptr;
  Json stages = {{"scan", config.at("scan")}, {"regrid", config.at("regrid")}, {"eval", config.at("eval")}};
  if (!config.at("hazard").is_null()) stages["hazard"] = config.at("hazard");
  return stages;
}

Json region_json(const EvaluationParameters& parameters) {
  switch (parameters.region_shape) {
    case RegionShape::circle:
      return {{"shape", "circle"}, {"radius_m", parameters.region_radius_m}};
    case RegionShape::square:
      return {{"shape", "square"}, {"half_width_m", parameters.region_half_width_m}};
    case RegionShape::mask:
      return {{"shape", "mask"}};
  }
  return {};
}

}  // namespace

ReportData draws_data(const DrawsReport& content, const nlohmann::json& config, std::int64_t most_cells) {
  const DrawTable& table = content.draws.table;
  const EvaluationParameters& parameters = content.parameters;
  const std::int64_t shown = std::min(table.size(), kMaxShownDraws);
  Packer packer;
  ReportData data;
  data.values = {
      {"colors", colors_json()},
      {"quantile", parameters.quantile},
      {"region", region_json(parameters)},
      {"layers", Json::array()},
      {"draw_count", table.size()},
      {"first_draw", table.first},
      {"seeds", seeds_json(table, shown)},
      {"pass", std::vector<int>(table.pass.begin(), table.pass.begin() + shown)},
      {"requirements", requirements_json(table, shown)},
      {"varied", columns_json(table.varied, shown, [](const DrawColumn&) { return true; })},
      {"metrics", columns_json(table.metrics, shown, is_shown)},
      {"stages", stages_json(config)}};
  if (content.draws.maps) {
    const GridSpec& spec = content.draws.maps->spec();
    const std::int64_t factor = reduction_factor(spec, most_cells);
    data.values["grid"] = grid_json(spec, factor);
    data.values["footprint"] = {
        {"shape", parameters.footprint_shape == FootprintShape::square ? "square" : "disc"},
        {"text", "footprint"},
        {"width_m", parameters.footprint_m},
        {"half_bins", footprint_of(parameters, spec.resolution_m).half_bins()}};
    data.values["layers"] = CampaignLayers(content.draws, factor, packer).all();
  }
  data.packed = packer.pack();
  return data;
}

}  // namespace landfall::html_report
