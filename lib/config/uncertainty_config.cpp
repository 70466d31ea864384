// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/uncertainty_config.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "base/abbreviated.h"
#include "base/error.h"
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

/// True if a part of the configuration differs from `none`; a part that an older scan lacks is off.
bool is_on(const Json& config, const char* where, const Json& none) {
  const Json::json_pointer pointer(where);
  return config.is_object() && config.contains(pointer) && config.at(pointer) != none;
}

double range_sigma_m(const std::vector<ScanOrigin>& scans) {
  static const Json::json_pointer kWhere("/noise/range_sigma_m");
  const std::string remedy = "; give --range-sigma METRES or /uncertainty/range_sigma_m";
  std::optional<double> common;
  for (const ScanOrigin& scan : scans) {
    const std::optional<double> sigma = number_at(scan.config, kWhere);
    if (!sigma) throw UsageError("--uncertainty: " + scan.name + " does not state its range noise" + remedy);
    for (const char* const where : {"/noise/range_sigma_per_m", "/noise/incidence_sigma_rad"})
      if (is_on(scan.config, where, 0))
        throw UsageError("--uncertainty: " + scan.name + " has range noise that is not uniform (" + where +
                         ")" + remedy);
    if (common && *common != *sigma)
      throw UsageError("--uncertainty: range noise " + number_text(*common) + " m in " + scans.front().name +
                       ", " + number_text(*sigma) + " m in " + scan.name + remedy);
    common = sigma;
  }
  return common.value_or(0);
}

/// A scan contains one draw of these errors, too.
bool has_no_pointing_error(const Json& config) {
  return !is_on(config, "/pointing_error/misalignment_rpy_rad", {0, 0, 0}) &&
         !(is_on(config, "/pointing_error/jitter_sigma_rad", 0) &&
           is_on(config, "/pointing_error/jitter_sigma_rad", {0, 0})) &&
         !is_on(config, "/pointing_error/time_stamp_bias_s", 0) &&
         !is_on(config, "/pointing_error/time_stamp_sigma_s", 0) &&
         !is_on(config, "/scanner/encoder_sigma_rad", 0);
}

bool has_no_navigation_error(const Json& config) {
  if (!config.is_object() || !config.contains("navigation_error") || !config["navigation_error"].is_object())
    return false;
  const Json none = {0, 0, 0};
  for (const char* const key : kNavigationKeys)
    if (config["navigation_error"].value(key, Json()) != none) return false;
  for (const char* const key : {"position_m_per_sqrt_s", "velocity_mps_per_sqrt_s", "rpy_rad_per_sqrt_s"})
    if (is_on(config, ("/navigation_error/random_walk/" + std::string(key)).c_str(), none)) return false;
  for (const char* const key : {"position_sigma_m", "velocity_sigma_mps", "rpy_sigma_rad"})
    if (is_on(config, ("/navigation_error/gauss_markov/" + std::string(key)).c_str(), none)) return false;
  return !config["navigation_error"].contains("table") && has_no_pointing_error(config);
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

NavigationSigma navigation_sigma(const Json& sigma) {
  return {.position_m = {vector3(sigma.at("position_m"))},
          .velocity_mps = {vector3(sigma.at("velocity_mps"))},
          .rpy_rad = roll_pitch_yaw(sigma.at("rpy_rad"), 1),
          .rpy_rate_radps = roll_pitch_yaw(sigma.at("rpy_rate_radps"), 1)};
}

Json as_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const RollPitchYaw& rpy) { return {rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad}; }

}  // namespace

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
