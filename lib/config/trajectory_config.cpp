// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_values.h"
#include "config/scan_components.h"
#include "trajectory/constant_velocity.h"
#include "trajectory/table_trajectory.h"
#include "trajectory/trajectory_columns.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::unique_ptr<const Trajectory> make_constant_velocity(const Json& json, const ComponentContext&) {
  return std::make_unique<ConstantVelocity>(
      ConstantVelocityParameters{{vector3(json.at("position_m"))},
                                 {vector3(json.at("velocity_mps"))},
                                 roll_pitch_yaw(json.at("rpy_deg"), kRadiansPerDegree),
                                 roll_pitch_yaw(json.at("rpy_rate_degps"), kRadiansPerDegree)});
}

std::unique_ptr<const Trajectory> make_table(const Json& json, const ComponentContext& context) {
  if (!context.load_table) return std::make_unique<ConstantVelocity>(ConstantVelocityParameters{});
  const NumberTable table =
      context.load_table(json.at("path").get<std::string>(), "trajectory", trajectory_columns());
  return std::make_unique<TableTrajectory>(trajectory_samples(table), table.file() + ": trajectory table");
}

constexpr ComponentMaker<Trajectory> kTrajectories[] = {
    {"constant_velocity", make_constant_velocity},
    {"table", make_table},
};

}  // namespace

std::unique_ptr<const Trajectory> make_trajectory(const Json& trajectory, const ComponentContext& context) {
  return make_component<Trajectory>(kTrajectories, trajectory, context);
}

}  // namespace landfall
