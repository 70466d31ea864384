// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "base/core/error.h"
#include "chain/lidar/error_models/random_navigation_error.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "store/config/json_values.h"
#include "store/config/scan_components.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

RandomWalkParameters random_walk(const Json& json) {
  return {{vector3(json.at("position_m_per_sqrt_s"))},
          {vector3(json.at("velocity_mps_per_sqrt_s"))},
          roll_pitch_yaw(json.at("rpy_rad_per_sqrt_s"), 1)};
}

GaussMarkovParameters gauss_markov(const Json& json) {
  return {{vector3(json.at("position_sigma_m"))},      json.at("position_time_s").get<double>(),
          {vector3(json.at("velocity_sigma_mps"))},    json.at("velocity_time_s").get<double>(),
          roll_pitch_yaw(json.at("rpy_sigma_rad"), 1), json.at("rpy_time_s").get<double>()};
}

void require_no_other_error(const Json& json) {
  const auto refuse_if = [](bool is_on, const std::string& key) {
    if (is_on) throw UsageError("table: excludes " + key + "; give one of them");
  };
  const Json none = {0, 0, 0};
  for (const char* const key : {"position_m", "velocity_mps", "rpy_rad", "rpy_rate_radps"})
    refuse_if(json.at(key) != none, key);
  refuse_if(json.at("attitude") != "truth", "attitude");
  refuse_if(random_walk(json.at("random_walk")) != RandomWalkParameters{}, "random_walk");
  refuse_if(!gauss_markov(json.at("gauss_markov")).is_none(), "gauss_markov");
}

}  // namespace

RangeErrors make_range_errors(const Json& noise, const ComponentContext& context) {
  const auto number = [&](const char* key) { return noise.at(key).get<double>(); };
  const auto [false_min, false_max] = pair_of(noise.at("false_range_m"));
  return {{.range_sigma_m = number("range_sigma_m"),
           .range_bias_m = number("range_bias_m"),
           .dead_pixel_frac = number("dead_pixel_frac"),
           .dropout_frac = number("dropout_frac"),
           .range_sigma_per_m = number("range_sigma_per_m"),
           .incidence_sigma_rad = number("incidence_sigma_rad"),
           .false_return_frac = number("false_return_frac"),
           .false_min_m = false_min,
           .false_max_m = false_max},
          context.seed};
}

PointingError make_pointing_error(const Json& json, const ComponentContext& context) {
  const auto [jitter_x, jitter_y] = pair_of(json.at("jitter_sigma_rad"));
  return {{.misalignment = roll_pitch_yaw(json.at("misalignment_rpy_rad"), 1),
           .jitter_sigma_x_rad = jitter_x,
           .jitter_sigma_y_rad = jitter_y,
           .time_stamp_bias_s = json.at("time_stamp_bias_s").get<double>(),
           .time_stamp_sigma_s = json.at("time_stamp_sigma_s").get<double>(),
           .mirror_time_bias_s = json.at("mirror_time_bias_s").get<double>(),
           .mirror_time_sigma_s = json.at("mirror_time_sigma_s").get<double>(),
           .jitter_time_s = json.at("jitter_time_s").get<double>(),
           .pulse_interval_s = context.pulse_interval_s},
          context.seed};
}

std::vector<std::string> pointing_warnings(const Json& resolved) {
  const Json& pointing = resolved.at("pointing_error");
  const auto is_set = [&](const char* key) { return pointing.at(key) != 0; };
  std::vector<std::string> warnings;
  if (is_set("jitter_time_s") && pair_of(pointing.at("jitter_sigma_rad")) == std::array{0.0, 0.0})
    warnings.emplace_back("/pointing_error/jitter_time_s has no effect without jitter_sigma_rad");
  if (resolved.at("scanner").at("type") == "flash")
    for (const char* const key : {"mirror_time_bias_s", "mirror_time_sigma_s"})
      if (is_set(key))
        warnings.push_back("/pointing_error/" + std::string(key) + " has no effect with the scanner flash");
  return warnings;
}

std::unique_ptr<const NavigationError> make_navigation_error(const Json& json,
                                                             const ComponentContext& context) {
  const NavigationErrorParameters linear{{vector3(json.at("position_m"))},
                                         {vector3(json.at("velocity_mps"))},
                                         roll_pitch_yaw(json.at("rpy_rad"), 1),
                                         roll_pitch_yaw(json.at("rpy_rate_radps"), 1)};
  const RandomNavigationParameters random{random_walk(json.at("random_walk")),
                                          gauss_markov(json.at("gauss_markov")),
                                          json.at("interval_s").get<double>()};
  if (random.random_walk == RandomWalkParameters{} && random.gauss_markov.is_none())
    return std::make_unique<LinearNavigationError>(linear);
  if (!context.load_table) {  // configuration check only: nothing is drawn
    RandomNavigationError::require_valid(random, context.scan_time_s);
    return std::make_unique<LinearNavigationError>(linear);
  }
  return std::make_unique<RandomNavigationError>(
      linear, random, RandomNavigationError::Draw{context.seed, context.scan_time_s});
}

std::unique_ptr<const Trajectory> make_estimate(const Json& json, const ComponentContext& context) {
  if (!json.contains("table")) return nullptr;
  require_no_other_error(json);
  if (!context.load_table) return std::make_unique<ConstantVelocity>(ConstantVelocityParameters{});
  const NumberTable table =
      context.load_table(json.at("table").get<std::string>(), "navigation", trajectory_columns());
  return std::make_unique<TableTrajectory>(trajectory_samples(table), table.file() + ": navigation table");
}

}  // namespace landfall
