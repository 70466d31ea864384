// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D89
#include "chain/lidar/error_models/random_navigation_error.h"

#include <string>

#include "base/text/parameter_check.h"

namespace landfall {
namespace {

/// Each process has nine axes: three each for position, velocity and attitude.
constexpr std::uint64_t kPositionAxis = 0;
constexpr std::uint64_t kVelocityAxis = 3;
constexpr std::uint64_t kAttitudeAxis = 6;

Eigen::Vector3d as_vector(const RollPitchYaw& rpy) { return {rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad}; }

void require_sigmas(const ParameterName& name, const Eigen::Vector3d& sigmas) {
  for (int i = 0; i < 3; ++i)
    require_not_negative({name.owner, name.key + "/" + std::to_string(i)}, sigmas[i]);
}

void check_random(const RandomWalkParameters& p) {
  const std::string owner = "random_walk";
  require_sigmas({owner, "position_m_per_sqrt_s"}, p.position_m_per_sqrt_s.v);
  require_sigmas({owner, "velocity_mps_per_sqrt_s"}, p.velocity_mps_per_sqrt_s.v);
  require_sigmas({owner, "rpy_rad_per_sqrt_s"}, as_vector(p.rpy_rad_per_sqrt_s));
}

void check_random(const GaussMarkovParameters& p) {
  const std::string owner = "gauss_markov";
  require_sigmas({owner, "position_sigma_m"}, p.position_sigma_m.v);
  require_sigmas({owner, "velocity_sigma_mps"}, p.velocity_sigma_mps.v);
  require_sigmas({owner, "rpy_sigma_rad"}, as_vector(p.rpy_sigma_rad));
  require_positive({owner, "position_time_s"}, p.position_time_s);
  require_positive({owner, "velocity_time_s"}, p.velocity_time_s);
  require_positive({owner, "rpy_time_s"}, p.rpy_time_s);
}

}  // namespace

bool GaussMarkovParameters::is_none() const {
  return position_sigma_m == Vector<DemFrame>{} && velocity_sigma_mps == Vector<DemFrame>{} &&
         rpy_sigma_rad == RollPitchYaw{};
}

RandomNavigationError::Process RandomNavigationError::walk(const RandomWalkParameters& p,
                                                           const TimeGrid& grid, RandomSeed seed) {
  const RandomField field(seed, RandomStream::navigation_walk);
  SampledPath position = random_walk(grid, p.position_m_per_sqrt_s.v, {field, kPositionAxis});
  position += random_walk(grid, p.velocity_mps_per_sqrt_s.v, {field, kVelocityAxis}).integral();
  return {std::move(position), random_walk(grid, as_vector(p.rpy_rad_per_sqrt_s), {field, kAttitudeAxis})};
}

RandomNavigationError::Process RandomNavigationError::markov(const GaussMarkovParameters& p,
                                                             const TimeGrid& grid, RandomSeed seed) {
  const RandomField field(seed, RandomStream::gauss_markov);
  SampledPath position =
      gauss_markov(grid, {p.position_sigma_m.v, p.position_time_s}, {field, kPositionAxis});
  position +=
      gauss_markov(grid, {p.velocity_sigma_mps.v, p.velocity_time_s}, {field, kVelocityAxis}).integral();
  return {std::move(position),
          gauss_markov(grid, {as_vector(p.rpy_sigma_rad), p.rpy_time_s}, {field, kAttitudeAxis})};
}

void RandomNavigationError::require_valid(const RandomNavigationParameters& random, double duration_s) {
  check_random(random.random_walk);
  check_random(random.gauss_markov);
  static_cast<void>(TimeGrid::covering(duration_s, random.interval_s));
}

RandomNavigationError::RandomNavigationError(const NavigationErrorParameters& linear,
                                             const RandomNavigationParameters& random, const Draw& draw)
    : linear_(linear) {
  require_valid(random, draw.duration_s);
  const TimeGrid grid = TimeGrid::covering(draw.duration_s, random.interval_s);
  if (random.random_walk != RandomWalkParameters{}) walk_ = walk(random.random_walk, grid, draw.seed);
  if (!random.gauss_markov.is_none()) markov_ = markov(random.gauss_markov, grid, draw.seed);
}

void RandomNavigationError::add(const Process& process, double since_start_s, PoseError& error) {
  const Eigen::Vector3d rpy = process.rpy_rad.at(since_start_s);
  error.p_err = error.p_err + Vector<DemFrame>{process.position_m.at(since_start_s)};
  error.R_err = error.R_err * rotation_from<BodyFrame, BodyFrame>({rpy.x(), rpy.y(), rpy.z()});
}

PoseError RandomNavigationError::error(double since_start_s) const {
  PoseError error = linear_.error(since_start_s);
  if (walk_) add(*walk_, since_start_s, error);
  if (markov_) add(*markov_, since_start_s, error);
  return error;
}

Transform<DemFrame, BodyFrame> RandomNavigationError::estimated(const Transform<DemFrame, BodyFrame>& truth,
                                                                double since_start_s) const {
  return landfall::estimated(truth, error(since_start_s));
}

}  // namespace landfall
