// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/numerics/random_seed.h"
#include "base/text/number_table.h"
#include "chain/lidar/detector/detector.h"
#include "chain/lidar/error_models/navigation_error.h"
#include "chain/lidar/error_models/pointing_error.h"
#include "chain/lidar/error_models/range_errors.h"
#include "chain/lidar/scanner/pattern.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/trajectory/trajectory.h"

namespace landfall {

/// Data that a component may need besides its own part of the configuration.
struct ComponentContext {
  /// Empty if the configuration is only checked: components that are defined by a file are then replaced by
  /// any valid one, and nothing is drawn.
  TableLoader load_table;
  RandomSeed seed = {};
  double scan_time_s = 2;
  double pulse_interval_s = 5e-5;
};

/// A kind of component by its "type". To add one: its class, a maker in the file of its group, an entry in
/// that file's list, and a definition in schemas/scan.schema.json.
template <class Component>
struct ComponentMaker {
  const char* type;
  std::unique_ptr<const Component> (*make)(const nlohmann::json& part, const ComponentContext& context);
};

/// `part` must be resolved, so that its "type" is in the list.
template <class Component>
std::unique_ptr<const Component> make_component(std::span<const ComponentMaker<Component>> makers,
                                                const nlohmann::json& part, const ComponentContext& context) {
  for (const ComponentMaker<Component>& maker : makers)
    if (part.at("type") == maker.type) return maker.make(part, context);
  throw std::logic_error("no maker for " + part.at("type").dump());
}

/// Each takes its part of a resolved scan configuration. All throw UsageError "key: ...", and FormatError for
/// an invalid table.
[[nodiscard]] Detector make_detector(const nlohmann::json& detector, const ComponentContext& context);
[[nodiscard]] std::unique_ptr<const Scanner> make_scanner(const nlohmann::json& scanner,
                                                          const ComponentContext& context);
/// Null if the scanner does not follow a pattern.
[[nodiscard]] std::unique_ptr<const Pattern> make_pattern(const nlohmann::json& scanner,
                                                          const ComponentContext& context);
[[nodiscard]] std::unique_ptr<const Trajectory> make_trajectory(const nlohmann::json& trajectory,
                                                                const ComponentContext& context);
/// The path with the departure that /trajectory_dispersion describes; the path itself where it is zero.
[[nodiscard]] std::unique_ptr<const Trajectory> dispersed(std::unique_ptr<const Trajectory> path,
                                                          const nlohmann::json& dispersion);
[[nodiscard]] RangeErrors make_range_errors(const nlohmann::json& noise, const ComponentContext& context);
[[nodiscard]] PointingError make_pointing_error(const nlohmann::json& pointing_error,
                                                const ComponentContext& context);
/// Warnings of keys of /pointing_error that are set but have no effect in this configuration of a whole scan.
[[nodiscard]] std::vector<std::string> pointing_warnings(const nlohmann::json& resolved);
/// Random errors are drawn for the context's scan time.
[[nodiscard]] std::unique_ptr<const NavigationError> make_navigation_error(
    const nlohmann::json& navigation_error, const ComponentContext& context);
/// The table of estimated poses; null if navigation_error does not name one.
[[nodiscard]] std::unique_ptr<const Trajectory> make_estimate(const nlohmann::json& navigation_error,
                                                              const ComponentContext& context);

}  // namespace landfall
