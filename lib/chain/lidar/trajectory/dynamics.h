// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "chain/lidar/trajectory/descent_control.h"
#include "chain/lidar/trajectory/rigid_body.h"
#include "chain/lidar/trajectory/trajectory.h"

namespace landfall {

/// Disturbance torque about the axes of B: a constant plus random draws.
struct DisturbanceTorque {
  Vector<BodyFrame> torque_nm{};
  Vector<BodyFrame> torque_sigma_nm{};  ///< one sigma of a normal draw per control period and axis
  std::uint64_t seed = 1;
};

struct DynamicsParameters {
  RigidBody body{};
  // The state at time 0.
  Point<DemFrame> position_m{{0, 0, 500}};
  Vector<DemFrame> velocity_mps{{0, 0, -23}};
  RollPitchYaw rpy{};
  Vector<BodyFrame> rate_radps{};  ///< of B against D

  double gravity_mps2 = 1.315;  ///< along -z_D, uniform
  DescentThrust thrust{};
  AttitudeControl attitude_control{};
  DisturbanceTorque disturbance{};
  double control_period_s = 0.01;
  double duration_s = 2;  ///< the motion is computed at least until this time
};

/// A rigid body's descent in six degrees of freedom: gravity, an engine that holds the descent rate, on-off
/// thrusters that hold the attitude within a deadband, and disturbance torques. Force and torque are updated
/// at the times k * control_period_s and held constant in between.
///
/// The constructor integrates the motion once and keeps the state at every control time, 112 bytes each. In
/// between, positions are cubic Hermite pieces with the known velocities, and attitudes are R_k exp(phi(t)),
/// phi the cubic Hermite piece of the rotation vector with the known rates. Both are continuous with their
/// rates. Their error is at most h^4/384 max|d^4/dt^4|, h the control period: at h = 0.01 s, below 1e-10 m
/// and 1e-10 rad for rates up to 1 rad/s. Turns about a principal axis and motion under a force of constant
/// direction are exact to rounding.
class DynamicsTrajectory : public Trajectory {
 public:
  /// Throws UsageError, naming the key, for a parameter that is not finite or out of range, for more
  /// than 2,000,000 control periods, and where the body could turn by more than 1 rad in one control
  /// period.
  explicit DynamicsTrajectory(const DynamicsParameters& parameters);

  /// A time that lies up to 1 ns outside the span counts as its end.
  [[nodiscard]] Pose pose(double t_s) const override;
  /// The last control time: duration_s or up to one control period later.
  [[nodiscard]] double end_time_s() const override;

  /// The planned motion at any time: from the first position with the first horizontal velocity and the
  /// commanded descent rate (without an engine: in free fall), in the commanded attitude (without thrusters:
  /// the first attitude).
  [[nodiscard]] Pose nominal_pose(double t_s) const override;

  /// The state at k * control_period_s, k = 0, 1, ...
  [[nodiscard]] const std::vector<RigidBodyState>& states() const { return states_; }

 private:
  DynamicsParameters parameters_;
  std::vector<RigidBodyState> states_;
};

}  // namespace landfall
