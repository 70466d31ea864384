// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D377
#include "store/config/draws_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"
#include "store/config/config_path.h"
#include "store/config/dem_config.h"
#include "store/config/hazard_config.h"
#include "store/config/key_effects.h"
#include "store/config/resolved_config.h"
#include "store/config/scan_config.h"
#include "store/config/schema.h"
#include "store/config/stage_sections.h"
#include "store/config/terrain_config.h"
#include "store/config/uncertainty_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// Merges `changes` over `base` (RFC 7396). An object of indices changes elements of an array: --set
/// scan.navigation_error.velocity_mps.0=0.1 means that of the scan's own.
void merge(Json& base, const Json& changes, const std::string& where) {
  if (!changes.is_object()) {
    base = changes;
    return;
  }
  if (!base.is_structured()) base = Json::object();
  for (const auto& [key, value] : changes.items()) {
    const std::string path = where + "/" + key;
    if (base.is_array()) {
      const Json::json_pointer element = Json::json_pointer() / key;
      if (!is_index(key) || !base.contains(element))
        throw UsageError(path + ": is not an index of an array of " + std::to_string(base.size()));
      merge(base.at(element), value, path);
    } else if (value.is_null()) {
      base.erase(key);
    } else {
      merge(base[key], value, path);
    }
  }
}

Json resolve_stage(const std::string& stage, const Json& config, const std::string& name) {
  return resolved_config(stage_source(stage, config, name), stage);
}

/// An object such as {"0": 0.1}, which changes elements of an array.
bool has_indices(const Json& node) {
  if (!node.is_object()) return false;
  for (const auto& [key, value] : node.items())
    if (!is_index(key)) return false;
  return !node.empty();
}

Json without_indices(Json node) {
  if (!node.is_object()) return node;
  for (auto item = node.begin(); item != node.end();) {
    if (has_indices(*item)) {
      item = node.erase(item);
    } else {
      *item = without_indices(std::move(*item));
      ++item;
    }
  }
  return node;
}

/// Turns objects of indices into the arrays that are the defaults of the configuration without them, with
/// changed elements.
void take_indices(Json& node, const std::string& stage, const Json& without, const std::string& pointer,
                  const std::string& name) {
  if (!node.is_object()) return;
  if (!has_indices(node)) {
    for (auto& [key, inner] : node.items()) take_indices(inner, stage, without, pointer + "/" + key, name);
    return;
  }
  Json changed = default_at(without, embedded_schema(stage), pointer);
  merge(changed, node, name + ": /" + stage + pointer);
  node = std::move(changed);
}

/// A section merged over `base`, with the defaults of the schema.
Json merged_stage(const std::string& stage, Json base, const Json& section, const std::string& name) {
  merge(base, section, name + ": /" + stage);
  take_indices(base, stage, without_indices(base), "", name);
  const JsonSource source = stage_source(stage, base, name);
  return stage == "terrain" ? resolve_terrain_config(source) : resolve_config(source, embedded_schema(stage));
}

/// The stage and the pointer within it of "scan.noise.range_sigma_m".
struct KeyPath {
  std::string stage;
  Json::json_pointer pointer;
};

KeyPath split_key(const std::string& key) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return {key, Json::json_pointer()};
  Json::json_pointer pointer;
  for (const std::string& part : split_at(key.substr(dot + 1), '.')) pointer /= part;
  return {key.substr(0, dot), pointer};
}

/// Why a key cannot vary on the rays of a scan; empty if it can.
std::string moves_rays_because(const Json::json_pointer& pointer, const Json& scan) {
  const std::optional<KeyEffect> effect = effect_of(pointer.to_string(), scan);
  if (effect == KeyEffect::beam)
    return "changes the rays, and the draws of a scan share them; leave out the scan, so that each draw "
           "traces its own";
  if (effect == KeyEffect::echo)
    return "changes the echoes that the scan keeps; leave out the scan, so that each draw traces its own";
  return {};
}

/// Why a key cannot vary in any run of draws; empty if it can.
std::string fixed_because(const std::string& key) {
  if (key == "scan.seed" || key == "terrain.seed")
    return "is the same in all draws, whose numbers make their random numbers differ";
  if (key == "scan.draw") return "is the number of the draw";
  if (key == "terrain.draw") return "is set by /terrain_seed";
  if (key.starts_with("landing.")) return "is the same in all draws";
  static constexpr std::array kGrid = {"regrid.half_width_m", "regrid.center_m", "regrid.resolution_m",
                                       "eval.region", "hazard.region"};
  for (const char* const prefix : kGrid)
    if (key.starts_with(prefix)) return "changes the bins that are judged, and all draws share them";
  if (key.starts_with("terrain.grid")) return "changes the grid of the terrain, and all draws share it";
  return {};
}

Variation<double> variation_of(const Json& json) {
  const std::string type = json.at("type");
  if (type == "normal") return NormalVariation{json.at("mean"), json.at("sigma")};
  if (type == "uniform") return UniformVariation{json.at("low"), json.at("high")};
  return ListVariation<double>{json.at("values").get<std::vector<double>>()};
}

LandingParameters landing_of(const Json& json) {
  LandingParameters landing;
  landing.drift_time_s = json.at("drift_time_s");
  if (json.at("yaw_deg").is_number()) landing.yaw_deg = json.at("yaw_deg").get<double>();
  if (!json.at("blind_sigma_m").is_null()) landing.blind_sigma_m = json.at("blind_sigma_m").get<double>();
  return landing;
}

/// The standard deviation of the values.
double sigma_of(const NormalVariation& variation) { return variation.sigma; }
double sigma_of(const UniformVariation& variation) {
  return (variation.high - variation.low) / std::sqrt(12.0);
}
double sigma_of(const ListVariation<double>& variation) {
  const auto n = static_cast<double>(variation.values.size());
  const double mean = std::accumulate(variation.values.begin(), variation.values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : variation.values) squares += (value - mean) * (value - mean);
  return n > 1 ? std::sqrt(squares / (n - 1)) : 0;
}

template <class Stages>
auto& stage_of(Stages& stages, const std::string& stage) {
  return stage == "scan"     ? stages.scan
         : stage == "regrid" ? stages.regrid
         : stage == "eval"   ? stages.eval
         : stage == "hazard" ? stages.hazard
                             : stages.terrain;
}

constexpr std::array kRedrawn = {"scan", "regrid", "eval"};

/// Sets a value of a configuration that has only some of the keys of the completed one: the default that
/// holds the value becomes part of it as a whole.
void set_value(Json& config, const Json& completed, const Json::json_pointer& where, double value) {
  Json::json_pointer missing = where;
  while (!config.contains(missing.parent_pointer())) missing = missing.parent_pointer();
  if (!config.contains(missing)) config[missing] = completed.at(missing);
  config[where] = value;
}

}  // namespace

DrawsConfig::DrawsConfig(const Json& resolved, std::string name, const Json& scanned,
                         const NumberTable* samples)
    : name_(std::move(name)),
      json_(resolved),
      draw_count_(resolved.at("draws")),
      metrics_(resolved.at("metrics") == "full" ? MetricsKind::full : MetricsKind::verdict),
      has_layers_(resolved.at("layers")),
      traces_(scanned.is_null()),
      has_uncertainty_(resolved.at("uncertainty")),
      has_terrain_seeds_(resolved.at("terrain_seed") == "each") {
  json_.erase("area");  // the sections have its values
  if (const Json& stop = resolved.at("stop"); stop.at("type") == "sprt") {
    sprt_ = {stop.at("p0"), stop.at("p1"), stop.at("alpha"), stop.at("beta")};
    at_path(name_ + ": /stop/", [&] { check(*sprt_); });
    tests_landing_ = stop.at("of") == "landing";
  }
  if (!traces_) require_scanned(resolved);
  const auto stage = [&](const char* which, Json base) {
    const Json& section = resolved.at(which);
    return section.is_null() ? Json() : merged_stage(which, std::move(base), section, name_);
  };
  scan_ = stage("scan", traces_ ? Json::object() : scanned);
  scan_["draw"] = 0;  // each draw has its own
  stages_ = {completed_scan_config(scan_), stage("regrid", Json::object()), stage("eval", Json::object()),
             stage("hazard", Json::object()), stage("terrain", Json::object())};
  if (has_hazards()) check_hazard_map(stages_.hazard, stages_.regrid, name_);
  seed_ = stages_.scan.at("seed");
  for (const std::string& each : stage_sections("draws")) json_[each] = stage_of(stages_, each);
  if (!resolved.at("landing").is_null()) landing_ = landing_of(resolved.at("landing"));
  if (landing_ && !has_hazards())
    throw UsageError(name_ + ": /landing: needs the section hazard, which finds the site");
  if (tests_landing_ && !landing_)
    throw UsageError(name_ + ": /stop/of: \"landing\" needs the section landing");
  if (has_terrain_seeds_ && !stages_.terrain.contains("seed"))
    throw UsageError(name_ + ": /terrain_seed: \"each\" needs a section terrain that has a seed");
  warn_of_draw(resolved.at("scan"), "scan");
  if (has_terrain_seeds_) warn_of_draw(resolved.at("terrain"), "terrain");
  if (has_uncertainty_ && stages_.regrid.at("method") != "bilinear_nearest")
    throw UsageError(name_ + ": /uncertainty: needs the method bilinear_nearest, not " +
                     stages_.regrid.at("method").get<std::string>());
  check_requirements();
  if (samples != nullptr) take_samples(*samples);
  json_["draws"] = draw_count_;
  for (const auto& [key, json] : resolved.at("vary").items())
    add_variation(name_ + ": /vary/", key, variation_of(json));
  terrain_varies_ = has_terrain_seeds_ || std::ranges::any_of(vary_, [](const auto& each) {
                      return each.first.starts_with("terrain.");
                    });
  if (resolved.at("sigma")) predict();
  if (!sprt_ || tests_landing_) return;
  if (const auto why = why_not_judged())
    throw UsageError(name_ + ": /stop: the sequential test is of requirements that are not judged: " + *why);
}

std::optional<std::int64_t> DrawsConfig::footprint_bins() const {
  if (footprint_varies()) return std::nullopt;
  const EvaluationParameters parameters = evaluation_config(stages_.eval, name_ + ": /eval");
  return footprint_of(parameters, stages_.regrid.at("resolution_m").get<double>()).edge_bins();
}

std::optional<std::string> DrawsConfig::why_not_judged() const {
  for (const std::int64_t draw :
       footprint_varies() ? deciding_draws(0, draw_count_) : std::vector<std::int64_t>{0}) {
    const DrawStages stages = footprint_varies() ? this->stages(draw) : stages_;
    const std::string of_draw = footprint_varies() ? "draw " + std::to_string(draw) + ": " : "";
    const auto why = landfall::why_not_judged(evaluation_config(stages.eval, name_ + ": /eval"),
                                              stages.regrid.at("resolution_m").get<double>());
    if (why) return of_draw + *why;
  }
  return std::nullopt;
}

void DrawsConfig::warn_of_draw(const Json& section, const char* stage) {
  if (section.is_object() && section.value("draw", 0) != 0)
    warnings_.push_back(name_ + ": /" + stage + "/draw has no effect: each draw has its own number");
}

void DrawsConfig::require_scanned(const Json& resolved) const {
  const auto refuse_if = [&](bool is_given, const char* key) {
    if (is_given) throw UsageError(name_ + ": /" + key + ": is for draws that trace; leave out the scan");
  };
  refuse_if(!resolved.at("terrain").is_null(), "terrain");
  refuse_if(has_terrain_seeds_, "terrain_seed");
  refuse_if(has_uncertainty_, "uncertainty");
}

void DrawsConfig::check_requirements() const {
  const std::string where = name_ + ": /eval";
  std::vector<Requirement> all = evaluation_config(stages_.eval, where).own_requirements;
  const std::vector<ResultField> decisive = decisive_fields();
  for (std::size_t i = 0; metrics_ == MetricsKind::verdict && i < all.size(); ++i)
    if (std::ranges::find(decisive, all[i].metric, &ResultField::path) == decisive.end())
      throw UsageError(where + ": /requirements/" + std::to_string(i) +
                       "/metric: \"metrics\": \"verdict\" does not compute " + all[i].metric +
                       "; set /metrics to \"full\"");
  if (!has_hazards()) return;
  for (const Requirement& own : hazard_config(stages_.hazard, name_ + ": /hazard").own_requirements)
    if (std::ranges::find(all, own.name, &Requirement::name) != all.end())
      throw UsageError(name_ + ": /hazard/requirements: \"" + own.name +
                       "\" is the name of a requirement of /eval too");
}

void DrawsConfig::predict() {
  if (!has_layers_) throw UsageError(name_ + ": /sigma: is a map, and /layers is false");
  if (terrain_varies_) throw UsageError(name_ + ": /sigma: is a map of one terrain, and the terrain varies");
  if (const std::string method = stages_.regrid.at("method"); method != "bilinear_nearest")
    throw UsageError(name_ + ": /sigma: needs the method bilinear_nearest, not " + method);
  Json regrid = stages_.regrid;
  if (!regrid["uncertainty"].contains("navigation_sigma")) {
    Json sigmas;
    for (const auto& [key, variation] : vary_) {
      static const std::string kPrefix = "scan.navigation_error.";
      if (!key.starts_with(kPrefix)) continue;
      const std::size_t dot = key.rfind('.');
      const std::string error = key.substr(kPrefix.size(), dot - kPrefix.size());
      if (std::ranges::find(navigation_sigma_keys(), error) == navigation_sigma_keys().end()) continue;
      for (const char* const other : navigation_sigma_keys())
        if (!sigmas.contains(other)) sigmas[other] = {0, 0, 0};
      sigmas[error][static_cast<std::size_t>(key.back() - '0')] =
          std::visit([](const auto& kind) { return sigma_of(kind); }, variation);
    }
    if (!sigmas.is_null()) regrid["uncertainty"]["navigation_sigma"] = std::move(sigmas);
  }
  predicted_ = uncertainty_parameters(regrid, name_ + ": /regrid", {{"the scan", stages_.scan}});
  json_["regrid"]["uncertainty"] = uncertainty_json(*predicted_);
}

void DrawsConfig::take_samples(const NumberTable& samples) {
  if (samples.row_count() == 0) samples.fail("has no row; a draw is a row");
  constexpr std::size_t kMaxDraws = 100'000;  // the bound of /draws in the schema
  if (samples.row_count() > kMaxDraws)
    samples.fail("has " + std::to_string(samples.row_count()) + " rows; a run has at most 100000 draws");
  draw_count_ = static_cast<std::int64_t>(samples.row_count());
  for (const std::string& key : samples.names()) {
    const std::vector<double>& values = samples.column(key);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i])) samples.fail_at(i, key + " is not a finite number");
    add_variation(samples.file() + ": ", key, ListVariation<double>{values});
  }
}

void DrawsConfig::add_variation(const std::string& owner, const std::string& key,
                                Variation<double> variation) {
  const std::string where = owner + key + ": ";
  if (vary_.contains(key)) throw UsageError(where + "is a column of the samples too");
  const auto [stage, pointer] = split_key(key);
  if (const std::string why = fixed_because(key); !why.empty()) throw UsageError(where + why);
  const bool is_known =
      traces_ ? std::ranges::find(stage_sections("draws"), stage) != stage_sections("draws").end()
              : std::ranges::find(kRedrawn, stage) != kRedrawn.end();
  if (!is_known)
    throw UsageError(where + "unknown key; its first part is scan, regrid" +
                     (traces_ ? ", eval, hazard or terrain" : " or eval"));
  if (!traces_ && stage == "scan")
    if (const std::string why = moves_rays_because(pointer, stages_.scan); !why.empty())
      throw UsageError(where + why);
  const Json& config = stage_of(stages_, stage);
  if (config.is_null()) throw UsageError(where + "there is no section " + stage);
  if (pointer.empty() || !config.contains(pointer)) throw UsageError(where + "unknown key of " + stage);
  if (!config.at(pointer).is_number())
    throw UsageError(where + "is not a number; an element of an array is its index, " + key + ".0");
  at_path(name_ + ": /", [&] { check(variation, key, static_cast<std::size_t>(draw_count_)); });
  vary_.emplace(key, std::move(variation));
}

std::vector<std::string> DrawsConfig::varied_keys() const {
  return mapped(vary_, [](const auto& varied) { return varied.first; });
}

std::vector<double> DrawsConfig::values(std::int64_t draw) const {
  return mapped(vary_, [&](const auto& varied) { return value(varied.second, varied.first, seed(draw)); });
}

std::vector<std::int64_t> DrawsConfig::deciding_draws(std::int64_t first, std::int64_t end) const {
  if (first >= end) return {};
  std::set<std::int64_t> draws = {first, end - 1};  // one of them is not the draw of the scan
  struct Deciding {
    double minimum, maximum;
    std::int64_t min_draw, max_draw;
    std::optional<std::int64_t> fraction_draw;
  };
  std::vector<Deciding> keys;
  for (const double value : values(first)) keys.push_back({value, value, first, first, {}});
  for (std::int64_t draw = first; draw < end; ++draw) {
    const std::vector<double> drawn = values(draw);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      Deciding& key = keys[i];
      if (drawn[i] < key.minimum) key.minimum = drawn[i], key.min_draw = draw;
      if (drawn[i] > key.maximum) key.maximum = drawn[i], key.max_draw = draw;
      if (!key.fraction_draw && drawn[i] != std::floor(drawn[i])) key.fraction_draw = draw;
    }
  }
  for (const Deciding& key : keys) {
    draws.insert({key.min_draw, key.max_draw});
    if (key.fraction_draw) draws.insert(*key.fraction_draw);
  }
  return {draws.begin(), draws.end()};
}

DrawStages DrawsConfig::stages(std::int64_t draw) const {
  DrawStages stages = stages_;
  stages.scan = scan_;
  stages.scan["draw"] = draw;
  if (has_terrain_seeds_) stages.terrain["draw"] = draw;
  const std::vector<double> drawn = values(draw);
  std::size_t i = 0;
  for (const auto& [key, variation] : vary_) {
    const auto [stage, pointer] = split_key(key);
    set_value(stage_of(stages, stage), stage_of(stages_, stage), pointer, drawn[i++]);
  }
  const std::string name = name_ + ": draw " + std::to_string(draw);
  for (const std::string& stage : stage_sections("draws"))
    if (Json& config = stage_of(stages, stage); !config.is_null())
      config = resolve_stage(stage, config, name);
  return stages;
}

void check_draws_config(const Json& resolved, const std::string& name, bool has_scan,
                        const NumberTable* samples) {
  if (!has_scan) {
    const DrawsConfig config(resolved, name, nullptr, samples);
    return static_cast<void>(config.stages(0));
  }
  static constexpr std::array kErrors = {"noise", "pointing_error", "navigation_error", "seed", "draw"};
  const Json& known = embedded_schema("scan").at("properties");
  Json config = resolved;
  if (resolved.at("scan").is_object())
    for (const auto& [key, value] : resolved.at("scan").items()) {
      if (std::ranges::find(kErrors, key) != kErrors.end()) continue;
      if (known.contains(key)) config["scan"].erase(key);  // an unknown key is refused with the others
    }
  static_cast<void>(DrawsConfig(config, name, resolve_stage("scan", Json::object(), name), samples));
}

}  // namespace landfall
