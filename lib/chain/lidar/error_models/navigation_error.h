// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/geometry/frames.h"
#include "base/geometry/rotation.h"

namespace landfall {

/// The error of the lander's estimate of its pose (Eq. 4).
struct PoseError {
  Vector<DemFrame> p_err{};
  Rotation<BodyFrame, BodyFrame> R_err{};
};

/// p_est = p - p_err, R_est = R R_err.
[[nodiscard]] Transform<DemFrame, BodyFrame> estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                       const PoseError& error);

/// The lander's estimate of its pose: a pure function of the truth and of the time since the first pulse.
class NavigationError {
 public:
  virtual ~NavigationError() = default;

  [[nodiscard]] virtual Transform<DemFrame, BodyFrame> estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                                 double since_start_s) const = 0;
};

struct NavigationErrorParameters {
  Vector<DemFrame> position_m{};    ///< a_p of Eq. 6, at the first pulse
  Vector<DemFrame> velocity_mps{};  ///< a_v
  RollPitchYaw rpy{};               ///< a_theta, at the first pulse
  RollPitchYaw rpy_rate_radps{};    ///< a_omega
};

/// Errors that grow linearly (Chen et al., Eqs. 4-6). With t the time since the first pulse:
///   p_err = a_p + a_v t,                          p_est = p - p_err      (frame D)
///   R_err = R(rpy = a_theta + a_omega t),         R_est = R R_err        (an error seen in the body)
/// The two signs differ: a positive position error is subtracted, a positive rotation error is applied.
class LinearNavigationError : public NavigationError {
 public:
  /// Throws UsageError, naming the key, where a number is not finite.
  explicit LinearNavigationError(const NavigationErrorParameters& parameters);

  [[nodiscard]] Transform<DemFrame, BodyFrame> estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                         double since_start_s) const override;
  [[nodiscard]] PoseError error(double since_start_s) const;

 private:
  NavigationErrorParameters parameters_;
};

}  // namespace landfall
