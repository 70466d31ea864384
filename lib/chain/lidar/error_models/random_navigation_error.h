// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/numerics/random_seed.h"
#include "chain/lidar/error_models/navigation_error.h"
#include "chain/lidar/error_models/sampled_path.h"

namespace landfall {

/// Densities q of random walks, per axis: sigma is q sqrt(t). All zero: no random walk.
struct RandomWalkParameters {
  Vector<DemFrame> position_m_per_sqrt_s{};
  Vector<DemFrame> velocity_mps_per_sqrt_s{};
  RollPitchYaw rpy_rad_per_sqrt_s{};

  friend bool operator==(const RandomWalkParameters&, const RandomWalkParameters&) = default;
};

/// First-order Gauss-Markov errors: stationary sigmas per axis, and correlation times. All sigmas zero: no
/// such error.
struct GaussMarkovParameters {
  Vector<DemFrame> position_sigma_m{};
  double position_time_s = 1;
  Vector<DemFrame> velocity_sigma_mps{};
  double velocity_time_s = 1;
  RollPitchYaw rpy_sigma_rad{};
  double rpy_time_s = 1;

  [[nodiscard]] bool is_none() const;
};

struct RandomNavigationParameters {
  RandomWalkParameters random_walk{};
  GaussMarkovParameters gauss_markov{};
  double interval_s = 0.01;  ///< of the time grid on which both are drawn
};

/// A linear error (Eq. 6) plus random errors, which the paper names as the alternative to Eq. 6:
///   p_err = p_linear + p_walk + p_gauss_markov, where each of the last two is a position process plus the
///   integral of a velocity process;
///   R_err = R_linear R_walk R_gauss_markov, each made of the roll, pitch and yaw at that time.
/// The constructor draws the processes once on a grid of times (sampled_path.h): 48 bytes per step and active
/// process. The draws of a process depend on (seed, draw, process, step, axis) only.
class RandomNavigationError : public NavigationError {
 public:
  struct Draw {
    RandomSeed seed = {};
    double duration_s = 2;  ///< length of the grid of times; afterwards the errors keep their last value
  };

  /// Throws UsageError, naming the key, where a sigma is negative, a time is not positive, a number is not
  /// finite, or the grid would have more than a million steps.
  RandomNavigationError(const NavigationErrorParameters& linear, const RandomNavigationParameters& random,
                        const Draw& draw);

  /// Throws the same errors as the constructor, but draws nothing.
  static void require_valid(const RandomNavigationParameters& random, double duration_s);

  [[nodiscard]] Transform<DemFrame, BodyFrame> estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                         double since_start_s) const override;
  [[nodiscard]] PoseError error(double since_start_s) const;

 private:
  struct Process {
    SampledPath position_m;  ///< with the integral of the velocity
    SampledPath rpy_rad;
  };
  [[nodiscard]] static Process walk(const RandomWalkParameters& p, const TimeGrid& grid, RandomSeed seed);
  [[nodiscard]] static Process markov(const GaussMarkovParameters& p, const TimeGrid& grid, RandomSeed seed);
  static void add(const Process& process, double since_start_s, PoseError& error);

  LinearNavigationError linear_;
  std::optional<Process> walk_;
  std::optional<Process> markov_;
};

}  // namespace landfall
