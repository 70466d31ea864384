// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/numerics/random.h"

namespace landfall {

/// Times 0, h, 2h, ..., `steps` h.
struct TimeGrid {
  double interval_s = 0.01;  ///< h
  std::size_t steps = 0;

  /// The shortest grid that covers `duration_s`. Throws UsageError, naming navigation_error/interval_s, where
  /// the interval is not finite and positive or the grid would have more than a million steps.
  [[nodiscard]] static TimeGrid covering(double duration_s, double interval_s);
};

/// Three numbers over time, given on a grid and linear between its points. Constant before the first and
/// after the last point.
class SampledPath {
 public:
  /// `values` has one more element than the grid has steps.
  SampledPath(const TimeGrid& grid, std::vector<Eigen::Vector3d> values);

  [[nodiscard]] Eigen::Vector3d at(double t_s) const;

  /// Adds element by element. Both paths must have the same grid.
  SampledPath& operator+=(const SampledPath& other);
  /// The integral from time 0 by the trapezoidal rule, exact at the grid points for a piecewise linear path.
  [[nodiscard]] SampledPath integral() const;

 private:
  TimeGrid grid_;
  std::vector<Eigen::Vector3d> values_;
};

/// Standard normal draws for three axes: functions of (seed, draw, stream, step, axis) only.
struct PathDraws {
  RandomField field;
  std::uint64_t first_axis = 0;  ///< this path uses the axis numbers first_axis .. first_axis + 2

  [[nodiscard]] Eigen::Vector3d at(std::uint64_t step) const;
};

/// Random walk (Wiener process): x_0 = 0, x_n = x_(n-1) + q sqrt(h) N(0, 1), per axis. Var x(t) = q^2 t at
/// the grid's points. `density` is q, in units of x per sqrt(s).
[[nodiscard]] SampledPath random_walk(const TimeGrid& grid, const Eigen::Vector3d& density,
                                      const PathDraws& draws);

struct GaussMarkov {
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
  double time_s = 1;  ///< tau
};

/// First-order Gauss-Markov process, stationary from the start, discretised exactly: x_0 = sigma N(0, 1),
/// x_n = f x_(n-1) + sigma sqrt(1 - f^2) N(0, 1), f = exp(-h / tau). At the grid's points Var x = sigma^2 and
/// E x(t) x(t + d) = sigma^2 exp(-d / tau).
[[nodiscard]] SampledPath gauss_markov(const TimeGrid& grid, const GaussMarkov& process,
                                       const PathDraws& draws);

}  // namespace landfall
