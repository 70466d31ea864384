// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D81, D82, D83
#include "chain/lidar/trajectory/dynamics.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/geometry/rotation_vector.h"
#include "base/geometry/vector_check.h"
#include "base/numerics/random.h"
#include "chain/lidar/trajectory/hermite.h"

namespace landfall {
namespace {

constexpr double kMaxPeriods = 2e6;
constexpr double kMaxTurn_rad = 1;

double period_count(const DynamicsParameters& p) {
  return std::max(1.0, std::ceil(p.duration_s / p.control_period_s - 1e-9));
}

void check_dynamics(const DynamicsParameters& p) {
  require_finite({"", "position_m"}, p.position_m.v);
  require_finite({"", "velocity_mps"}, p.velocity_mps.v);
  require_finite({"", "rpy_deg"}, p.rpy);
  require_finite({"", "rate_degps"}, p.rate_radps.v);
  require_not_negative({"", "gravity_mps2"}, p.gravity_mps2);
  require_positive({"", "control_period_s"}, p.control_period_s);
  require_positive({"", "duration_s"}, p.duration_s);
  require(period_count(p) <= kMaxPeriods, {"", "control_period_s"}, p.control_period_s,
          "long enough: the scan would take more than 2000000 control periods");
  require_valid(p.thrust, p.control_period_s);
  require_valid(p.attitude_control);
  require_finite({"disturbance", "torque_nm"}, p.disturbance.torque_nm.v);
  for (int i = 0; i < 3; ++i)
    require_not_negative({"disturbance", "torque_sigma_nm/" + std::to_string(i)},
                         p.disturbance.torque_sigma_nm.v[i]);
}

/// The disturbance torque during a control period.
class Disturbance {
 public:
  explicit Disturbance(const DynamicsParameters& p)
      : torque_(p.disturbance), draws_(p.disturbance.seed, RandomStream::disturbance) {}

  [[nodiscard]] Vector<BodyFrame> torque(std::uint64_t period) const {
    Vector<BodyFrame> result = torque_.torque_nm;
    for (int i = 0; i < 3; ++i)
      if (torque_.torque_sigma_nm.v[i] > 0)
        result.v[i] += torque_.torque_sigma_nm.v[i] * draws_.normal(period, static_cast<std::uint64_t>(i));
    return result;
  }

 private:
  DisturbanceTorque torque_;
  RandomField draws_;
};

RigidBodyState first_state(const DynamicsParameters& p) {
  return {p.position_m, p.velocity_mps, Eigen::Quaterniond(rotation_matrix(p.rpy)), p.rate_radps};
}

/// Refuses a control period in which the body turns too far for its attitude to be interpolated.
void require_short(double period_s, const RigidBody& body, const RigidBodyState& state, const Load& load) {
  const double gained = period_s * body.inertia_kgm2.inverse().norm() * load.torque_nm.norm();
  require(period_s * (state.rate_radps.norm() + gained) <= kMaxTurn_rad, {"", "control_period_s"}, period_s,
          "short enough: the body could turn by more than 1 rad in it");
}

std::vector<RigidBodyState> integrate(const DynamicsParameters& p) {
  const RigidBodyMotion motion(p.body);
  const Disturbance disturbance(p);
  const auto periods = static_cast<std::size_t>(period_count(p));
  std::vector<RigidBodyState> states{first_state(p)};
  states.reserve(periods + 1);
  for (std::size_t k = 0; k < periods; ++k) {
    const RigidBodyState& now = states.back();
    const Load load{{{0, 0, -p.gravity_mps2}},
                    thrust_of(p.thrust, p.gravity_mps2, p.body.mass_kg, now),
                    torque_of(p.attitude_control, now) + disturbance.torque(k)};
    require_short(p.control_period_s, p.body, now, load);
    states.push_back(motion.after(p.control_period_s, now, load));
  }
  return states;
}

Eigen::Quaterniond attitude_between(double u, double h, const RigidBodyState& a, const RigidBodyState& b) {
  const Eigen::Vector3d turned = rotation_vector(a.attitude.conjugate() * b.attitude);
  const Eigen::Vector3d phi = hermite(u, {Eigen::Vector3d::Zero(), h * a.rate_radps.v},
                                      {turned, h * rotation_vector_rate(turned, b.rate_radps.v)});
  return (a.attitude * quaternion_of(phi)).normalized();
}

}  // namespace

DynamicsTrajectory::DynamicsTrajectory(const DynamicsParameters& parameters) : parameters_(parameters) {
  check_dynamics(parameters_);
  states_ = integrate(parameters_);
}

double DynamicsTrajectory::end_time_s() const {
  return static_cast<double>(states_.size() - 1) * parameters_.control_period_s;
}

Pose DynamicsTrajectory::pose(double t_s) const {
  if (!(t_s >= -kTimeSlack_s && t_s <= end_time_s() + kTimeSlack_s))
    throw FormatError("trajectory: time " + number_text(t_s) +
                      " s lies outside the integrated motion, 0 .. " + number_text(end_time_s()) + " s");
  const double h = parameters_.control_period_s;
  const double periods = std::max(0.0, t_s / h);
  const auto k = std::min(static_cast<std::size_t>(periods), states_.size() - 2);
  const double u = std::min(1.0, periods - static_cast<double>(k));
  const RigidBodyState& a = states_[k];
  const RigidBodyState& b = states_[k + 1];
  const Eigen::Vector3d position =
      hermite(u, {a.position_m.v, h * a.velocity_mps.v}, {b.position_m.v, h * b.velocity_mps.v});
  return {{attitude_between(u, h, a, b).toRotationMatrix()}, {position}};
}

Pose DynamicsTrajectory::nominal_pose(double t_s) const {
  const DynamicsParameters& p = parameters_;
  Eigen::Vector3d position = p.position_m.v + t_s * p.velocity_mps.v;
  if (p.thrust.max_n > 0)
    position.z() = p.position_m.v.z() - p.thrust.descent_rate_mps * t_s;
  else
    position.z() -= 0.5 * p.gravity_mps2 * t_s * t_s;
  const RollPitchYaw attitude = p.attitude_control.is_on() ? p.attitude_control.command : p.rpy;
  return {rotation_from<DemFrame, BodyFrame>(attitude), {position}};
}

}  // namespace landfall
