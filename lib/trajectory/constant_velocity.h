// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "geometry/rotation.h"
#include "geometry/vector_check.h"
#include "trajectory/trajectory.h"

namespace landfall {

struct ConstantVelocityParameters {
  Point<DemFrame> position_m{{0, 0, 500}};  ///< at t0
  Vector<DemFrame> velocity_mps{{0, 0, -23}};
  RollPitchYaw rpy{};  ///< at t0
  RollPitchYaw rpy_rate_radps{};
};

/// p = position + velocity t; roll, pitch and yaw are each linear in t; t0 = 0. The motion has no beginning
/// and no end: times before 0 are extrapolated.
class ConstantVelocity : public Trajectory {
 public:
  /// Throws UsageError, naming the key, where a number is not finite.
  explicit ConstantVelocity(const ConstantVelocityParameters& parameters) : parameters_(parameters) {
    require_finite({"", "position_m"}, parameters.position_m.v);
    require_finite({"", "velocity_mps"}, parameters.velocity_mps.v);
    require_finite({"", "rpy_deg"}, parameters.rpy);
    require_finite({"", "rpy_rate_degps"}, parameters.rpy_rate_radps);
  }

  [[nodiscard]] Pose pose(double t_s) const override {
    const RollPitchYaw rpy = linear(parameters_.rpy, t_s, parameters_.rpy_rate_radps);
    return {rotation_from<DemFrame, BodyFrame>(rpy), parameters_.position_m + t_s * parameters_.velocity_mps};
  }
  [[nodiscard]] double earliest_time_s() const override { return -std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double end_time_s() const override { return std::numeric_limits<double>::infinity(); }

 private:
  ConstantVelocityParameters parameters_;
};

}  // namespace landfall
