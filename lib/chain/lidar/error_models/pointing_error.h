// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "base/geometry/frames.h"
#include "base/geometry/rotation.h"
#include "base/numerics/random.h"
#include "chain/lidar/error_models/pulse_process.h"

namespace landfall {

struct PointingErrorParameters {
  RollPitchYaw misalignment{};    ///< of the true lidar against its nominal mount, about the nominal L's axes
  double jitter_sigma_x_rad = 0;  ///< about x_L, one sigma, per pulse
  double jitter_sigma_y_rad = 0;  ///< about y_L
  double time_stamp_bias_s = 0;   ///< pose time - pulse time, in [-1e6, 1e6]
  double time_stamp_sigma_s = 0;  ///< one sigma, per pulse, in [0, 1e6]
  /// Time of the true mirror - time of the pulse, in [-1, 1]; negative for a mirror that lags.
  double mirror_time_bias_s = 0;
  double mirror_time_sigma_s = 0;  ///< one sigma, per pulse, in [0, 1]
  double jitter_time_s = 0;        ///< tau, correlation time of the jitter, in [0, 1e6]; 0: none
  double pulse_interval_s = 0;     ///< positive with a jitter_time
};

/// The true direction and time of the lidar, as opposed to the estimated ones.
///
/// On the true side, the whole lidar, exit points included, turns about its origin:
///   R_body_lidar_true = R_body_lidar R_lidar_true,   R_lidar_true = R_misalignment R(rpy = (j_x, j_y, 0)),
/// j_x and j_y drawn per pulse: independently or, with a correlation time tau, as first-order Gauss-Markov
/// processes with E j(t) j(t + d) = sigma^2 exp(-d / tau) (PulseProcess). The estimate uses the nominal
/// mount. A beam along +z_L thereby moves by -j_x along y_L and by +j_y along x_L (to first order).
///
/// On the estimated side, a pulse at t is combined with the estimated pose at t + e, e = bias
/// + N(0, sigma) per pulse.
///
/// Mirror clock: at the pulse at t the true mechanism is where its pattern or its motor puts it at t + e, e =
/// bias + N(0, sigma) per pulse, while the lander computes its points from the mechanism at t. The poses are
/// not affected. A sweep that moves a footprint at w m/s thus puts the true points w e ahead of the estimated
/// ones: 10 km/s x 10 us = 0.1 m, with alternating sign along a boustrophedon.
///
/// Every draw is a function of (seed, draw, cause, pulse).
class PointingError {
 public:
  /// Without any error.
  PointingError() : PointingError({}, 0) {}
  /// Throws UsageError, naming the key, where a sigma is negative, a number not finite or a time out of
  /// range.
  PointingError(const PointingErrorParameters& parameters, RandomSeed seed);

  /// False: R_lidar_true is the identity at every pulse.
  [[nodiscard]] bool turns_beams() const { return turns_beams_; }
  /// R_lidar_true: from the true to the nominal lidar frame.
  [[nodiscard]] Rotation<LidarFrame, LidarFrame> rotation(std::int64_t pulse) const;
  /// The time-stamp error e of the pulse, seconds.
  [[nodiscard]] double time_stamp_error_s(std::int64_t pulse) const;
  /// The mirror-clock error e of the pulse, seconds.
  [[nodiscard]] double mirror_time_error_s(std::int64_t pulse) const;
  /// An upper bound of time_stamp_error_s(): the bias and 9 sigma (RandomField's normal draws end at 8.6).
  [[nodiscard]] double largest_time_stamp_error_s() const;

 private:
  PointingErrorParameters parameters_;
  bool turns_beams_;
  Rotation<LidarFrame, LidarFrame> misalignment_;
  RandomField jitter_;
  std::optional<PulseProcess> jitter_process_;
  RandomField time_stamp_;
  RandomField mirror_time_;
};

}  // namespace landfall
