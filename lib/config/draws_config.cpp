// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/draws_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "base/error.h"
#include "config/config_path.h"
#include "config/hazard_config.h"
#include "config/key_effects.h"
#include "config/scan_config.h"
#include "config/schema.h"
#include "config/uncertainty_config.h"

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
  Json resolved = resolve_config({name + ": /" + stage, config}, embedded_schema(stage));
  if (stage == "scan") complete_scan_config(resolved);
  return resolved;
}

/// A stage's configuration merged over `base` and completed.
Json merged_stage(const std::string& stage, Json base, const Json& changes, const std::string& name) {
  merge(base, changes, name + ": /" + stage);
  return resolve_stage(stage, base, name);
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
  for (std::size_t begin = dot + 1, end = 0; end != std::string::npos; begin = end + 1) {
    end = key.find('.', begin);
    pointer /= key.substr(begin, end - begin);
  }
  return {key.substr(0, dot), pointer};
}

/// Why a key cannot vary on the same rays, grid and region; empty if it can.
std::string fixed_because(const std::string& key) {
  if (key == "scan.seed") return "is set by the number of the draw";
  if (const auto& [stage, pointer] = split_key(key); stage == "scan") {
    const std::optional<KeyEffect> effect = effect_of(pointer.to_string());
    if (effect == KeyEffect::beam)
      return "changes the rays, and only errors are drawn anew; trace a scan for each value "
             "(docs/user/studies)";
    if (effect == KeyEffect::echo)
      return "changes the echoes that the scan keeps; trace a scan for each value (docs/user/studies)";
  }
  static constexpr std::array kGrid = {"regrid.half_width_m", "regrid.resolution_m", "eval.region"};
  for (const char* const prefix : kGrid)
    if (key.starts_with(prefix)) return "changes the bins that are judged, and all draws share them";
  return {};
}

Variation<double> variation_of(const Json& json) {
  const std::string type = json.at("type");
  if (type == "normal") return NormalVariation{json.at("mean"), json.at("sigma")};
  if (type == "uniform") return UniformVariation{json.at("low"), json.at("high")};
  return ListVariation<double>{json.at("values").get<std::vector<double>>()};
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

const Json& stage_of(const DrawStages& stages, const std::string& stage) {
  return stage == "scan" ? stages.scan : stage == "regrid" ? stages.regrid : stages.eval;
}

}  // namespace

DrawsConfig::DrawsConfig(const Json& resolved, std::string name, const Json& scanned,
                         const NumberTable* samples)
    : name_(std::move(name)),
      json_(resolved),
      draw_count_(resolved.at("draws")),
      metrics_(resolved.at("metrics") == "full" ? MetricsKind::full : MetricsKind::verdict),
      has_layers_(resolved.at("layers")) {
  json_.erase("area");  // the sections have its values
  if (const Json& stop = resolved.at("stop"); stop.at("type") == "sprt") {
    sprt_ = {stop.at("p0"), stop.at("p1"), stop.at("alpha"), stop.at("beta")};
    at_path(name_ + ": /stop/", [&] { check(*sprt_); });
  }
  const auto defaults = [&](const char* stage) { return resolve_stage(stage, Json::object(), name_); };
  stages_ = {merged_stage("scan", scanned, resolved.at("scan"), name_),
             merged_stage("regrid", defaults("regrid"), resolved.at("regrid"), name_),
             merged_stage("eval", defaults("eval"), resolved.at("eval"), name_)};
  seed_ = stages_.scan.at("seed");
  for (const char* const stage : {"scan", "regrid", "eval"}) json_[stage] = stage_of(stages_, stage);
  if (!resolved.at("hazard").is_null()) {
    json_["hazard"] = resolve_stage("hazard", resolved.at("hazard"), name_);
    hazard_ = hazard_config(json_["hazard"]);
  }
  if (samples != nullptr) take_samples(*samples);
  json_["draws"] = draw_count_;
  for (const auto& [key, json] : resolved.at("vary").items())
    add_variation(name_ + ": /vary/", key, variation_of(json));
  if (resolved.at("sigma")) predict();
}

void DrawsConfig::predict() {
  if (!has_layers_) throw UsageError(name_ + ": /sigma: is a map, and /layers is false");
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
  constexpr std::size_t kMostDraws = 100'000;  // the bound of /draws in the schema
  if (samples.row_count() > kMostDraws)
    samples.fail("has " + std::to_string(samples.row_count()) + " rows; a campaign has at most 100000 draws");
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
  if (stage != "scan" && stage != "regrid" && stage != "eval")
    throw UsageError(where + "unknown key; its first part is scan, regrid or eval");
  if (const std::string why = fixed_because(key); !why.empty()) throw UsageError(where + why);
  const Json& config = stage_of(stages_, stage);
  if (pointer.empty() || !config.contains(pointer)) throw UsageError(where + "unknown key of " + stage);
  if (!config.at(pointer).is_number())
    throw UsageError(where + "is not a number; an element of an array is its index, " + key + ".0");
  at_path(name_ + ": /", [&] { check(variation, key, static_cast<std::size_t>(draw_count_)); });
  vary_.emplace(key, std::move(variation));
}

std::vector<std::string> DrawsConfig::varied_keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, variation] : vary_) keys.push_back(key);
  return keys;
}

std::vector<double> DrawsConfig::values(std::int64_t draw) const {
  std::vector<double> values;
  for (const auto& [key, variation] : vary_)
    values.push_back(
        value(variation, key, static_cast<std::uint64_t>(seed_), static_cast<std::size_t>(draw)));
  return values;
}

std::vector<std::int64_t> DrawsConfig::deciding_draws(std::int64_t first, std::int64_t end) const {
  if (first >= end) return {};
  std::set<std::int64_t> draws = {first, end - 1};  // one of them has another seed than the scan
  struct Deciding {
    double least, greatest;
    std::int64_t least_draw, greatest_draw;
    std::optional<std::int64_t> fraction_draw;
  };
  std::vector<Deciding> keys;
  for (const double value : values(first)) keys.push_back({value, value, first, first, {}});
  for (std::int64_t draw = first; draw < end; ++draw) {
    const std::vector<double> drawn = values(draw);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      Deciding& key = keys[i];
      if (drawn[i] < key.least) key.least = drawn[i], key.least_draw = draw;
      if (drawn[i] > key.greatest) key.greatest = drawn[i], key.greatest_draw = draw;
      if (!key.fraction_draw && drawn[i] != std::floor(drawn[i])) key.fraction_draw = draw;
    }
  }
  for (const Deciding& key : keys) {
    draws.insert({key.least_draw, key.greatest_draw});
    if (key.fraction_draw) draws.insert(*key.fraction_draw);
  }
  return {draws.begin(), draws.end()};
}

DrawStages DrawsConfig::stages(std::int64_t draw) const {
  DrawStages stages = stages_;
  stages.scan["seed"] = seed(draw);
  const std::vector<double> drawn = values(draw);
  std::size_t i = 0;
  for (const auto& [key, variation] : vary_) {
    const auto [stage, pointer] = split_key(key);
    (stage == "scan" ? stages.scan : stage == "regrid" ? stages.regrid : stages.eval)[pointer] = drawn[i++];
  }
  const std::string name = name_ + ": draw " + std::to_string(draw);
  return {resolve_stage("scan", stages.scan, name), resolve_stage("regrid", stages.regrid, name),
          resolve_stage("eval", stages.eval, name)};
}

void check_draws_config(const Json& resolved, const std::string& name, const NumberTable* samples) {
  static constexpr std::array kErrors = {"noise", "pointing_error", "navigation_error", "seed"};
  const Json& known = embedded_schema("scan").at("properties");
  Json config = resolved;
  for (const auto& [key, value] : resolved.at("scan").items()) {
    if (std::ranges::find(kErrors, key) != kErrors.end()) continue;
    if (known.contains(key)) config["scan"].erase(key);  // an unknown key is refused with the others
  }
  static_cast<void>(DrawsConfig(config, name, resolve_stage("scan", Json::object(), name), samples));
}

}  // namespace landfall
