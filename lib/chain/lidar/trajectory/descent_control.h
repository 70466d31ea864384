// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/geometry/rotation.h"
#include "chain/lidar/trajectory/rigid_body.h"

namespace landfall {

/// A throttled engine along +z_B through the centre of mass that holds the descent rate.
struct DescentThrust {
  double descent_rate_mps = 23;  ///< -v_z in D
  double gain_per_s = 1;         ///< gain of the velocity error; 0: thrust balances the weight only
  double max_n = 2000;           ///< 0: without an engine
};

/// On-off thrusters, one pair about each body axis, with a deadband.
struct AttitudeControl {
  RollPitchYaw command{};
  double deadband_rad = 1e-3;
  double rate_gain_s = 0.5;
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Constant(20);  ///< about x_B, y_B, z_B; 0: without thrusters

  [[nodiscard]] bool is_on() const { return torque_nm != Eigen::Vector3d::Zero(); }
};

/// The engine's force for this state, along z_B:
///   F = m (g + k (v_z,commanded - v_z)) / cos(tilt), within [0, max_n],
/// where tilt is the angle between z_B and z_D; 0 where z_B points sideways or down. The horizontal velocity
/// is not controlled.
[[nodiscard]] Vector<BodyFrame> thrust_of(const DescentThrust& thrust, double weight_per_mass_mps2,
                                          double mass_kg, const RigidBodyState& state);

/// The thrusters' torque for this state. About each axis s = theta + rate_gain_s * omega, theta the shortest
/// rotation vector from the commanded attitude to the body's, in B: -torque where s > deadband, +torque where
/// s < -deadband, else 0.
///
/// With torques held over control periods h, the control ends in a limit cycle. One firing changes the rate
/// by d = torque h / I. From the rate d/2 each firing reverses the motion, and the body swings between the
/// angles +-(W/2 .. W/2 + d h/2), W/2 = deadband - rate_gain_s d/2, with a period of 4 W/d + (2 .. 6) h;
/// within a firing it swings d h/8 further.
[[nodiscard]] Vector<BodyFrame> torque_of(const AttitudeControl& control, const RigidBodyState& state);

/// Throw UsageError, naming the key, for numbers that are not finite or out of range. `control_period_s`
/// bounds the gain: above 1 / control_period_s, thrust that is held overshoots.
void require_valid(const DescentThrust& thrust, double control_period_s);
void require_valid(const AttitudeControl& control);

}  // namespace landfall
