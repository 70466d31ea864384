// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/draws_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "config/config_path.h"
#include "config/scan_config.h"
#include "config/schema.h"
#include "config/uncertainty_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// A stage's configuration merged over `base` and completed.
Json resolved_stage(const std::string& stage, Json base, const Json& changes, const std::string& name) {
  base.merge_patch(changes);
  Json resolved = resolve_config({name + ": /" + stage, std::move(base)}, embedded_schema(stage));
  if (stage == "scan") complete_scan_config(resolved);
  return resolved;
}

/// The stage and the pointer within it of "scan.noise.range_sigma_m".
struct KeyPath {
  std::string stage;
  Json::json_pointer pointer;
};

KeyPath split_key(const std::string& key) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return {key, Json::json_pointer()};
  std::string pointer = "/" + key.substr(dot + 1);
  for (char& c : pointer)
    if (c == '.') c = '/';
  return {key.substr(0, dot), Json::json_pointer(pointer)};
}

/// Why a key cannot vary on the same rays, grid and region; empty if it can.
std::string fixed_because(const std::string& key) {
  static constexpr std::array kRays = {"scan.detector.",  "scan.laser.",      "scan.scanner.",
                                       "scan.mount.",     "scan.trajectory.", "scan.pointing_error.misalignment_rpy_rad",
                                       "scan.pointing_error.jitter_sigma_rad"};
  for (const char* const prefix : kRays)
    if (key.starts_with(prefix))
      return "changes the rays, and only errors are drawn anew; trace a scan for each value (docs/user/studies)";
  if (key == "scan.seed") return "is set by the number of the draw";
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
double sigma_of(const UniformVariation& variation) { return (variation.high - variation.low) / std::sqrt(12.0); }
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

DrawsConfig::DrawsConfig(const Json& resolved, std::string name, const Json& scanned, const NumberTable* samples)
    : name_(std::move(name)),
      json_(resolved),
      draw_count_(resolved.at("draws")),
      metrics_(resolved.at("metrics") == "full" ? MetricsKind::full : MetricsKind::verdict),
      has_layers_(resolved.at("layers")) {
  if (const Json& stop = resolved.at("stop"); stop.at("type") == "sprt") {
    sprt_ = {stop.at("p0"), stop.at("p1"), stop.at("alpha"), stop.at("beta")};
    at_path(name_ + ": /stop/", [&] { check(*sprt_); });
  }
  stages_ = {resolved_stage("scan", scanned, resolved.at("scan"), name_),
             resolved_stage("regrid", Json::object(), resolved.at("regrid"), name_),
             resolved_stage("eval", Json::object(), resolved.at("eval"), name_)};
  seed_ = stages_.scan.at("seed");
  for (const char* const stage : {"scan", "regrid", "eval"}) json_[stage] = stage_of(stages_, stage);
  if (samples != nullptr) take_samples(*samples);
  json_["draws"] = draw_count_;
  for (const auto& [key, json] : resolved.at("vary").items()) add_variation(key, variation_of(json));
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
  draw_count_ = static_cast<std::int64_t>(samples.row_count());
  for (const std::string& key : samples.names()) {
    const std::vector<double>& values = samples.column(key);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i])) samples.fail_at(i, key + " is not a finite number");
    at_path(samples.file() + ": ", [&] { add_variation(key, ListVariation<double>{values}); });
  }
}

void DrawsConfig::add_variation(const std::string& key, Variation<double> variation) {
  const std::string where = name_ + ": /vary/" + key + ": ";
  if (vary_.contains(key)) throw UsageError(where + "is a column of the samples too");
  const auto [stage, pointer] = split_key(key);
  if (stage != "scan" && stage != "regrid" && stage != "eval")
    throw UsageError(where + "unknown key; keys begin with scan., regrid. or eval.");
  const Json& config = stage_of(stages_, stage);
  if (pointer.empty() || !config.contains(pointer)) throw UsageError(where + "unknown key of " + stage);
  if (const std::string why = fixed_because(key); !why.empty()) throw UsageError(where + why);
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
  return {resolved_stage("scan", std::move(stages.scan), Json::object(), name),
          resolved_stage("regrid", std::move(stages.regrid), Json::object(), name),
          resolved_stage("eval", std::move(stages.eval), Json::object(), name)};
}

}  // namespace landfall
