// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/geometry/frames.h"

namespace landfall {

struct RigidBody {
  double mass_kg = 500;
  /// About the centre of mass, the origin of B, along B's axes.
  Eigen::Matrix3d inertia_kgm2 = Eigen::Vector3d(300, 300, 400).asDiagonal();
};

struct RigidBodyState {
  Point<DemFrame> position_m{};  ///< centre of mass
  Vector<DemFrame> velocity_mps{};
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< D <- B, Hamilton
  Vector<BodyFrame> rate_radps{};                                ///< of B against D, seen in B
};

/// The gravity, force and torque on the body, held constant over an interval.
struct Load {
  Vector<DemFrame> gravity_mps2{};
  Vector<BodyFrame> force_n{};    ///< turns with the body
  Vector<BodyFrame> torque_nm{};  ///< about the centre of mass
};

/// The motion of a rigid body under gravity and a force and a torque that stay constant over an interval:
///   p' = v,   v' = g + R F / m,   q' = q (0, omega) / 2,   I omega' = tau - omega x I omega.
class RigidBodyMotion {
 public:
  /// Throws UsageError unless the mass is positive and the inertia is physically possible: symmetric, with
  /// positive principal moments, none of which exceeds the sum of the other two.
  explicit RigidBodyMotion(const RigidBody& body);

  /// The state `duration_s` later: Runge-Kutta-Fehlberg 7(8), with steps chosen so that a step's error stays
  /// below 1e-13 relative plus 1e-13 absolute in each of the 13 numbers. The returned attitude is normalised.
  [[nodiscard]] RigidBodyState after(double duration_s, const RigidBodyState& from, const Load& load) const;

  [[nodiscard]] const RigidBody& body() const { return body_; }

 private:
  RigidBody body_;
  Eigen::Matrix3d inverse_inertia_;
};

}  // namespace landfall
