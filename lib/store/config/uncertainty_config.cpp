// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D90, D258
#include "store/config/uncertainty_config.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

#include "base/core/error.h"
#include "base/numerics/light.h"
#include "base/text/characters.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"
#include "store/config/config_path.h"
#include "store/config/json_values.h"
#include "store/config/key_effects.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 4> kNavigationKeys = {"position_m", "velocity_mps", "rpy_rad",
                                                        "rpy_rate_radps"};

double sigma_of(const std::string& text, const std::string& assignment) {
  const auto value = exact_number<double>(trimmed(text));
  if (!value)
    throw UsageError("--navigation-sigma " + abbreviated(assignment) + ": '" + abbreviated(text) +
                     "' is not a number; expected KEY=SIGMA or KEY=X,Y,Z");
  return *value;
}

std::vector<double> sigmas_of(const std::string& text, const std::string& assignment) {
  std::vector<double> sigmas;
  for (const std::string& part : split_at(text, ',')) sigmas.push_back(sigma_of(part, assignment));
  if (sigmas.size() == 1) sigmas.assign(3, sigmas.front());
  if (sigmas.size() != 3)
    throw UsageError("--navigation-sigma " + abbreviated(assignment) + ": " + std::to_string(sigmas.size()) +
                     " numbers; expected 1 or 3");
  return sigmas;
}

/// The number at a path such as /noise/range_sigma_m; nothing if the scan does not have it.
std::optional<double> number_at(const Json& config, const Json::json_pointer& where) {
  if (!config.is_object() || !config.contains(where) || !config.at(where).is_number()) return std::nullopt;
  return config.at(where).get<double>();
}

/// True if a part of the configuration differs from all of these values; a part that an older scan lacks is
/// off.
bool is_on(const Json& config, const std::string& where, const std::vector<Json>& off) {
  const Json::json_pointer pointer(where);
  return config.is_object() && config.contains(pointer) &&
         std::ranges::find(off, config.at(pointer)) == off.end();
}

/// The keys of a scan's configuration that are on and whose error this sigma covers.
std::vector<std::string> errors_of(const Json& config, CoveringSigma sigma) {
  std::vector<std::string> errors;
  for (const EffectiveKey& key : keys_in_effect(config))
    if (key.sigma == sigma) errors.push_back(key.pointer);
  return errors;
}

/// The white errors of the timer besides the range noise: jitter, and rounding to steps, uniform over one.
double with_timer(double range_sigma_m, const Json& config) {
  const double jitter_m =
      range_of_time_m(number_at(config, Json::json_pointer("/receiver/jitter_sigma_s")).value_or(0));
  const double step_m =
      range_of_time_m(number_at(config, Json::json_pointer("/receiver/timer_step_s")).value_or(0));
  if (jitter_m == 0 && step_m == 0) return range_sigma_m;
  return std::sqrt(range_sigma_m * range_sigma_m + jitter_m * jitter_m + step_m * step_m / 12);
}

double range_sigma_m(const std::vector<ScanOrigin>& scans, const UncertaintyWords& words) {
  static const Json::json_pointer kWhere("/noise/range_sigma_m");
  const std::string remedy = "; give " + words.range_sigma;
  std::optional<double> common;
  for (const ScanOrigin& scan : scans) {
    std::optional<double> sigma = number_at(scan.config, kWhere);
    if (!sigma) throw UsageError(words.subject + scan.name + " does not state its range noise" + remedy);
    if (const auto errors = errors_of(scan.config, CoveringSigma::given); !errors.empty())
      throw UsageError(words.subject + scan.name + " has range noise that is not uniform (" + errors.front() +
                       ")" + remedy);
    if (is_on(scan.config, "/receiver/type", {"none"}))
      throw UsageError(words.subject + scan.name +
                       " has range noise that follows the signal (/receiver/type)" + remedy);
    sigma = with_timer(*sigma, scan.config);
    if (common && *common != *sigma)
      throw UsageError(words.subject + "range noise " + number_text(*common) + " m in " + scans.front().name +
                       ", " + number_text(*sigma) + " m in " + scan.name + remedy);
    common = sigma;
  }
  return common.value_or(0);
}

/// The navigation and pointing errors other than the keys of kNavigationKeys.
std::vector<std::string> other_navigation_errors(const Json& config) {
  std::vector<std::string> errors = errors_of(config, CoveringSigma::navigation);
  std::erase_if(errors, [](const std::string& where) {
    return std::ranges::any_of(
        kNavigationKeys, [&](const char* key) { return where == std::string("/navigation_error/") + key; });
  });
  return errors;
}

bool has_no_navigation_error(const Json& config) {
  if (!config.is_object() || !config.contains("navigation_error") || !config["navigation_error"].is_object())
    return false;
  const Json none = {0, 0, 0};
  for (const char* const key : kNavigationKeys)
    if (config["navigation_error"].value(key, Json()) != none) return false;
  return other_navigation_errors(config).empty();
}

void require_no_navigation_error(const std::vector<ScanOrigin>& scans, const UncertaintyWords& words) {
  for (const ScanOrigin& scan : scans)
    if (!has_no_navigation_error(scan.config))
      throw UsageError(words.subject + scan.name +
                       " may have a navigation or pointing error of unknown sigma; give " +
                       words.navigation_sigma);
}

/// The navigation and pointing errors of a scan for which the sigmas are 0.
std::vector<std::string> navigation_left_out(const NavigationSigma& sigma, const Json& config) {
  const std::array<bool, 4> covered = {
      sigma.position_m != Vector<DemFrame>{}, sigma.velocity_mps != Vector<DemFrame>{},
      sigma.rpy_rad != RollPitchYaw{}, sigma.rpy_rate_radps != RollPitchYaw{}};
  const Json none = {0, 0, 0};
  std::vector<std::string> errors;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    const std::string where = std::string("/navigation_error/") + kNavigationKeys[i];
    if (!covered[i] && is_on(config, where, {none})) errors.push_back(where);
  }
  if (std::ranges::none_of(covered, std::identity()))
    std::ranges::copy(other_navigation_errors(config), std::back_inserter(errors));
  return errors;
}

/// Whether a key that is on makes an error, given the other keys.
bool matters(const std::string& where, const Json& config) {
  const auto is = [&](const char* other, const Json& value) {
    const Json::json_pointer pointer(other);
    return config.contains(pointer) && config.at(pointer) == value;
  };
  if (where == "/pointing_error/jitter_time_s")
    return is_on(config, "/pointing_error/jitter_sigma_rad", {0, {0, 0}});
  if (where == "/detector/estimator")
    return is_on(config, "/detector/subpixels", {1}) && is("/detector/estimator", "first");
  if (where.starts_with("/scanner/facet_tilt_")) return !is("/scanner/facet_tilt_known", true);
  return true;
}

/// Errors that are not random, or follow no normal distribution.
std::vector<std::string> never_covered(const Json& config) {
  std::vector<std::string> errors = errors_of(config, CoveringSigma::never);
  std::erase_if(errors, [&](const std::string& where) { return !matters(where, config); });
  return errors;
}

NavigationSigma navigation_sigma(const Json& sigma) {
  return {.position_m = {vector3(sigma.at("position_m"))},
          .velocity_mps = {vector3(sigma.at("velocity_mps"))},
          .rpy_rad = roll_pitch_yaw(sigma.at("rpy_rad"), 1),
          .rpy_rate_radps = roll_pitch_yaw(sigma.at("rpy_rate_radps"), 1)};
}

Json as_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const RollPitchYaw& rpy) { return {rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad}; }

}  // namespace

const std::array<const char*, 4>& navigation_sigma_keys() { return kNavigationKeys; }

void add_navigation_sigma(Json& config, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  const std::string key = assignment.substr(0, equals);
  if (equals == std::string::npos || std::ranges::find(kNavigationKeys, key) == kNavigationKeys.end())
    throw UsageError(
        "--navigation-sigma " + abbreviated(assignment) +
        ": expected KEY=SIGMA or KEY=X,Y,Z; KEY is position_m, velocity_mps, rpy_rad or rpy_rate_radps");
  Json& sigmas = config["uncertainty"]["navigation_sigma"];
  for (const char* const other : kNavigationKeys)
    if (!sigmas.contains(other)) sigmas[other] = {0, 0, 0};
  sigmas[key] = sigmas_of(assignment.substr(equals + 1), assignment);
}

UncertaintyWords uncertainty_words(const std::string& name) {
  if (!name.ends_with(": /regrid"))
    return {"--uncertainty: ", "--range-sigma METRES or /uncertainty/range_sigma_m",
            "--navigation-sigma position_m=METRES (or velocity_mps=, rpy_rad=, rpy_rate_radps=; 0 for none) "
            "or /uncertainty/navigation_sigma"};
  return {name + ": ", "regrid.uncertainty.range_sigma_m=METRES",
          R"(regrid.uncertainty.navigation_sigma={"position_m":[X,Y,Z]} (or velocity_mps, rpy_rad, )"
          "rpy_rate_radps; [0,0,0] for none)"};
}

UncertaintyParameters uncertainty_parameters(const Json& config, const std::string& name,
                                             const std::vector<ScanOrigin>& scans) {
  const Json given = config.value("uncertainty", Json::object());
  const UncertaintyWords words = uncertainty_words(name);
  UncertaintyParameters parameters;
  parameters.range_sigma_m =
      given.contains("range_sigma_m") ? given["range_sigma_m"].get<double>() : range_sigma_m(scans, words);
  if (given.contains("navigation_sigma"))
    parameters.navigation = navigation_sigma(given["navigation_sigma"]);
  else
    require_no_navigation_error(scans, words);
  at_path(name + ": /uncertainty/", [&] { check(parameters); });
  return parameters;
}

std::vector<std::string> errors_left_out(const UncertaintyParameters& parameters,
                                         const std::vector<ScanOrigin>& scans) {
  std::vector<std::string> all;
  for (const ScanOrigin& scan : scans)
    for (const auto& errors :
         {never_covered(scan.config), navigation_left_out(parameters.navigation, scan.config)})
      for (const std::string& error : errors)
        if (std::ranges::find(all, error) == all.end()) all.push_back(error);
  return all;
}

Json uncertainty_json(const UncertaintyParameters& parameters) {
  const NavigationSigma& navigation = parameters.navigation;
  return {{"range_sigma_m", parameters.range_sigma_m},
          {"navigation_sigma",
           {{"position_m", as_json(navigation.position_m.v)},
            {"velocity_mps", as_json(navigation.velocity_mps.v)},
            {"rpy_rad", as_json(navigation.rpy_rad)},
            {"rpy_rate_radps", as_json(navigation.rpy_rate_radps)}}}};
}

}  // namespace landfall
