// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lander.h"
#include "navigation.h"

namespace lander {

/// First-order lag of engine and thrusters, within their limits.
class Actuators {
 public:
  struct Limits {
    double thrust_n = 1800;
    double torque_nm = 60;  ///< per axis
    double thrust_lag_s = 0.15;
    double torque_lag_s = 0.05;
  };
  explicit Actuators(const Limits& limits, const Controls& now) : limits_(limits), now_(now) {}
  /// The controls at the end of a period, given those at its start and the command.
  const Controls& follow(const Controls& command, double period_s);

 private:
  Limits limits_;
  Controls now_;
};

/// Flies down at a constant rate above the origin of D, upright, yaw 0; sees only what the filter knows. With
/// a site it flies above that, and brakes at a constant rate to stand on it.
class Controller {
 public:
  struct Gains {
    double descent_mps = 23;
    double descent_gain_per_s = 0.5;
    double braking_mps2 = 0.8;
    double touchdown_mps = 1;
    double position_gain_per_s2 = 0.04;
    double velocity_gain_per_s = 0.32;
    double tilt_limit_rad = 0.14;
    double attitude_frequency_radps = 1.2;  ///< of the bus's closed loop, were it rigid and alone
    double attitude_damping = 0.8;
  };
  Controller(const Gains& gains, const Design& design) : gains_(gains), design_(design) {}
  /// A place of the ground, in D as the lander's map has it.
  void land_at(const Vector3d& site_m) { site_m_ = site_m; }
  [[nodiscard]] Controls command(const BusState& estimate) const;

 private:
  /// The acceleration up that keeps the rate of descent.
  [[nodiscard]] double braking(const BusState& estimate) const;
  /// The specific force to fly, in D.
  [[nodiscard]] Vector3d guidance(const BusState& estimate) const;

  Gains gains_;
  Design design_;
  std::optional<Vector3d> site_m_;
};

}  // namespace lander
