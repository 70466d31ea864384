// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/uncertainty_config.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "base/abbreviated.h"
#include "base/error.h"
#include "base/light.h"
#include "base/number_text.h"
#include "config/config_path.h"
#include "config/json_values.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 4> kNavigationKeys = {"position_m", "velocity_mps", "rpy_rad",
                                                        "rpy_rate_radps"};

double sigma_of(const std::string& text, const std::string& assignment) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw UsageError("--navigation-sigma " + abbreviated(assignment) + ": '" + abbreviated(text) +
                     "' is not a number; expected KEY=SIGMA or KEY=X,Y,Z");
  return value;
}

std::vector<double> sigmas_of(const std::string& text, const std::string& assignment) {
  std::vector<double> sigmas;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    sigmas.push_back(sigma_of(text.substr(begin, comma - begin), assignment));
    begin = comma + 1;
  }
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

/// The white errors of the timer beside the range noise: jitter, and rounding to steps, uniform over one.
double with_timer(double range_sigma_m, const Json& config) {
  const double jitter_m =
      range_of_time_m(number_at(config, Json::json_pointer("/receiver/jitter_sigma_s")).value_or(0));
  const double step_m =
      range_of_time_m(number_at(config, Json::json_pointer("/receiver/timer_step_s")).value_or(0));
  if (jitter_m == 0 && step_m == 0) return range_sigma_m;
  return std::sqrt(range_sigma_m * range_sigma_m + jitter_m * jitter_m + step_m * step_m / 12);
}

double range_sigma_m(const std::vector<ScanOrigin>& scans) {
  static const Json::json_pointer kWhere("/noise/range_sigma_m");
  const std::string remedy = "; give --range-sigma METRES or /uncertainty/range_sigma_m";
  std::optional<double> common;
  for (const ScanOrigin& scan : scans) {
    std::optional<double> sigma = number_at(scan.config, kWhere);
    if (!sigma) throw UsageError("--uncertainty: " + scan.name + " does not state its range noise" + remedy);
    for (const char* const where : {"/noise/range_sigma_per_m", "/noise/incidence_sigma_rad"})
      if (is_on(scan.config, where, {0}))
        throw UsageError("--uncertainty: " + scan.name + " has range noise that is not uniform (" + where +
                         ")" + remedy);
    if (is_on(scan.config, "/receiver/type", {"none"}))
      throw UsageError("--uncertainty: " + scan.name +
                       " has range noise that follows the signal (/receiver/type)" + remedy);
    sigma = with_timer(*sigma, scan.config);
    if (common && *common != *sigma)
      throw UsageError("--uncertainty: range noise " + number_text(*common) + " m in " + scans.front().name +
                       ", " + number_text(*sigma) + " m in " + scan.name + remedy);
    common = sigma;
  }
  return common.value_or(0);
}

/// The parts of a scan's configuration that give it a navigation or pointing error, beside the keys of
/// kNavigationKeys.
std::vector<std::string> other_navigation_errors(const Json& config) {
  const Json none = {0, 0, 0};
  std::vector<std::string> errors;
  for (const auto& [where, off] : std::initializer_list<std::pair<const char*, std::vector<Json>>>{
           {"/navigation_error/random_walk/position_m_per_sqrt_s", {none}},
           {"/navigation_error/random_walk/velocity_mps_per_sqrt_s", {none}},
           {"/navigation_error/random_walk/rpy_rad_per_sqrt_s", {none}},
           {"/navigation_error/gauss_markov/position_sigma_m", {none}},
           {"/navigation_error/gauss_markov/velocity_sigma_mps", {none}},
           {"/navigation_error/gauss_markov/rpy_sigma_rad", {none}},
           {"/navigation_error/table", {}},
           {"/pointing_error/misalignment_rpy_rad", {none}},
           {"/pointing_error/jitter_sigma_rad", {0, {0, 0}}},
           {"/pointing_error/time_stamp_bias_s", {0}},
           {"/pointing_error/time_stamp_sigma_s", {0}},
           {"/scanner/encoder_sigma_rad", {0}}})
    if (is_on(config, where, off)) errors.emplace_back(where);
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

void require_no_navigation_error(const std::vector<ScanOrigin>& scans) {
  for (const ScanOrigin& scan : scans)
    if (!has_no_navigation_error(scan.config))
      throw UsageError(
          "--uncertainty: " + scan.name +
          " may have a navigation or pointing error of unknown sigma; give "
          "--navigation-sigma position_m=METRES (or velocity_mps=, rpy_rad=, rpy_rate_radps=; 0 for "
          "none) or /uncertainty/navigation_sigma");
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

/// Errors that are not random, or follow no normal distribution.
std::vector<std::string> never_covered(const Json& config) {
  std::vector<std::string> errors;
  for (const char* const where :
       {"/noise/range_bias_m", "/noise/false_return_frac", "/pointing_error/mirror_time_bias_s",
        "/pointing_error/mirror_time_sigma_s", "/receiver/pixel_offset_sigma_m", "/receiver/clock_scale_ppm"})
    if (is_on(config, where, {0})) errors.emplace_back(where);
  if (is_on(config, "/pointing_error/jitter_time_s", {0}) &&
      is_on(config, "/pointing_error/jitter_sigma_rad", {0, {0, 0}}))
    errors.emplace_back("/pointing_error/jitter_time_s");
  if (is_on(config, "/receiver/pixel_offset_table", {})) errors.emplace_back("/receiver/pixel_offset_table");
  if (is_on(config, "/receiver/type", {"none"})) errors.emplace_back("/receiver/type");
  static const Json::json_pointer kEstimator("/detector/estimator");
  if (is_on(config, "/detector/subpixels", {1}) && config.contains(kEstimator) &&
      config.at(kEstimator) == "first")
    errors.emplace_back("/detector/estimator");
  if (is_on(config, "/scanner/tof_lag", {false})) errors.emplace_back("/scanner/tof_lag");
  if (is_on(config, "/scanner/encoder_harmonics", {Json::array()}))
    errors.emplace_back("/scanner/encoder_harmonics");
  if (!is_on(config, "/scanner/facet_tilt_known", {false})) {
    if (is_on(config, "/scanner/facet_tilt_rad", {Json::array()}))
      errors.emplace_back("/scanner/facet_tilt_rad");
    if (is_on(config, "/scanner/facet_tilt_sigma_rad", {0}))
      errors.emplace_back("/scanner/facet_tilt_sigma_rad");
  }
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
  if (equals == std::string::npos ||
      std::find(kNavigationKeys.begin(), kNavigationKeys.end(), key) == kNavigationKeys.end())
    throw UsageError(
        "--navigation-sigma " + abbreviated(assignment) +
        ": expected KEY=SIGMA or KEY=X,Y,Z; KEY is position_m, velocity_mps, rpy_rad or rpy_rate_radps");
  Json& sigmas = config["uncertainty"]["navigation_sigma"];
  for (const char* const other : kNavigationKeys)
    if (!sigmas.contains(other)) sigmas[other] = {0, 0, 0};
  sigmas[key] = sigmas_of(assignment.substr(equals + 1), assignment);
}

UncertaintyParameters uncertainty_parameters(const Json& config, const std::string& name,
                                             const std::vector<ScanOrigin>& scans) {
  const Json given = config.value("uncertainty", Json::object());
  UncertaintyParameters parameters;
  parameters.range_sigma_m =
      given.contains("range_sigma_m") ? given["range_sigma_m"].get<double>() : range_sigma_m(scans);
  if (given.contains("navigation_sigma"))
    parameters.navigation = navigation_sigma(given["navigation_sigma"]);
  else
    require_no_navigation_error(scans);
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
