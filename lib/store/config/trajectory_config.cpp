// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "chain/lidar/trajectory/dynamics.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "chain/lidar/trajectory/trajectories.h"
#include "store/config/json_values.h"
#include "store/config/scan_components.h"

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

std::unique_ptr<const Trajectory> make_table_trajectory(const Json& json, const ComponentContext& context) {
  if (!context.load_table) return std::make_unique<ConstantVelocity>(ConstantVelocityParameters{});
  const NumberTable table =
      context.load_table(json.at("path").get<std::string>(), "trajectory", trajectory_columns());
  return std::make_unique<TableTrajectory>(trajectory_samples(table), table.file() + ": trajectory table");
}

RigidBody rigid_body_of(const Json& json) {
  const Eigen::Vector3d moments = vector3(json.at("inertia_kgm2"));
  const Eigen::Vector3d products = vector3(json.at("inertia_products_kgm2"));
  RigidBody body{.mass_kg = json.at("mass_kg").get<double>()};
  body.inertia_kgm2 << moments.x(), products.x(), products.y(),  //
      products.x(), moments.y(), products.z(),                   //
      products.y(), products.z(), moments.z();
  return body;
}

DescentThrust thrust_of(const Json& json) {
  return {json.at("descent_rate_mps").get<double>(), json.at("gain_per_s").get<double>(),
          json.at("max_n").get<double>()};
}

AttitudeControl attitude_control_of(const Json& json) {
  return {roll_pitch_yaw(json.at("command_rpy_deg"), kRadiansPerDegree), radians(json, "deadband_deg"),
          json.at("rate_gain_s").get<double>(), vector3(json.at("torque_nm"))};
}

std::unique_ptr<const Trajectory> make_dynamics(const Json& json, const ComponentContext& context) {
  const Json& disturbance = json.at("disturbance");
  return std::make_unique<DynamicsTrajectory>(
      DynamicsParameters{.body = rigid_body_of(json),
                         .position_m = {vector3(json.at("position_m"))},
                         .velocity_mps = {vector3(json.at("velocity_mps"))},
                         .rpy = roll_pitch_yaw(json.at("rpy_deg"), kRadiansPerDegree),
                         .rate_radps = {kRadiansPerDegree * vector3(json.at("rate_degps"))},
                         .gravity_mps2 = json.at("gravity_mps2").get<double>(),
                         .thrust = thrust_of(json.at("thrust")),
                         .attitude_control = attitude_control_of(json.at("attitude_control")),
                         .disturbance = {{vector3(disturbance.at("torque_nm"))},
                                         {vector3(disturbance.at("torque_sigma_nm"))},
                                         disturbance.at("seed").get<std::uint64_t>()},
                         .control_period_s = json.at("control_period_s").get<double>(),
                         .duration_s = context.scan_time_s});
}

constexpr ComponentMaker<Trajectory> kTrajectories[] = {
    {"constant_velocity", make_constant_velocity},
    {"table", make_table_trajectory},
    {"dynamics", make_dynamics},
};

}  // namespace

std::unique_ptr<const Trajectory> make_trajectory(const Json& trajectory, const ComponentContext& context) {
  return make_component<Trajectory>(kTrajectories, trajectory, context);
}

std::unique_ptr<const Trajectory> dispersed(std::unique_ptr<const Trajectory> path, const Json& json) {
  const DispersionParameters departure{{vector3(json.at("position_m"))},
                                       {vector3(json.at("velocity_mps"))},
                                       roll_pitch_yaw(json.at("rpy_rad"), 1),
                                       roll_pitch_yaw(json.at("rpy_rate_radps"), 1)};
  if (departure == DispersionParameters{}) return path;
  return std::make_unique<DispersedTrajectory>(std::move(path), departure);
}

}  // namespace landfall
