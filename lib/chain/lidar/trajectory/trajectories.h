// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <memory>
#include <utility>

#include "base/geometry/rotation.h"
#include "base/geometry/vector_check.h"
#include "chain/lidar/trajectory/trajectory.h"

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

/// How the true path departs from the configured one; all linear in the time since the first pulse.
struct DispersionParameters {
  Vector<DemFrame> position_m{};
  Vector<DemFrame> velocity_mps{};
  RollPitchYaw rpy{};
  RollPitchYaw rpy_rate_radps{};

  friend bool operator==(const DispersionParameters&, const DispersionParameters&) = default;
};

/// p = p_path + position + velocity t, R = R_path Rz(yaw) Ry(pitch) Rx(roll), the angles rpy + rpy_rate t.
/// The nominal pose stays that of the path.
class DispersedTrajectory : public Trajectory {
 public:
  /// Throws UsageError, naming the key, where a number is not finite.
  DispersedTrajectory(std::unique_ptr<const Trajectory> path, const DispersionParameters& parameters)
      : path_(std::move(path)), parameters_(parameters) {
    require_finite({"", "position_m"}, parameters.position_m.v);
    require_finite({"", "velocity_mps"}, parameters.velocity_mps.v);
    require_finite({"", "rpy_rad"}, parameters.rpy);
    require_finite({"", "rpy_rate_radps"}, parameters.rpy_rate_radps);
  }

  [[nodiscard]] Pose pose(double t_s) const override {
    const Pose on_path = path_->pose(t_s);
    const RollPitchYaw rpy = linear(parameters_.rpy, t_s, parameters_.rpy_rate_radps);
    return {on_path.rotation * rotation_from<BodyFrame, BodyFrame>(rpy),
            on_path.position + parameters_.position_m + t_s * parameters_.velocity_mps};
  }
  [[nodiscard]] Pose nominal_pose(double t_s) const override { return path_->nominal_pose(t_s); }
  [[nodiscard]] double epoch_s() const override { return path_->epoch_s(); }
  [[nodiscard]] double earliest_time_s() const override { return path_->earliest_time_s(); }
  [[nodiscard]] double end_time_s() const override { return path_->end_time_s(); }

 private:
  std::unique_ptr<const Trajectory> path_;
  DispersionParameters parameters_;
};

}  // namespace landfall
