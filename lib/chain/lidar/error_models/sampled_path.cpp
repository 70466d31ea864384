// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/error_models/sampled_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "base/numerics/portable_math.h"
#include "base/text/number_text.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr double kMaxPathSteps = 1e6;  // 24 MB per path

}  // namespace

TimeGrid TimeGrid::covering(double duration_s, double interval_s) {
  const ParameterName name{"", "interval_s"};
  require_positive(name, interval_s);
  const double steps = std::max(1.0, std::ceil(duration_s / interval_s));
  const std::string bound = "long enough: " + number_text(duration_s) +
                            " s, the scan and its time-stamp errors, would have more than a million steps";
  require(steps <= kMaxPathSteps, name, interval_s, bound.c_str());
  return {interval_s, static_cast<std::size_t>(steps)};
}

SampledPath::SampledPath(const TimeGrid& grid, std::vector<Eigen::Vector3d> values)
    : grid_(grid), values_(std::move(values)) {
  assert(values_.size() == grid_.steps + 1);
}

Eigen::Vector3d SampledPath::at(double t_s) const {
  const double position = std::clamp(t_s / grid_.interval_s, 0.0, static_cast<double>(grid_.steps));
  const std::size_t i = std::min(static_cast<std::size_t>(position), grid_.steps - 1);
  const double u = position - static_cast<double>(i);
  return (1 - u) * values_[i] + u * values_[i + 1];
}

SampledPath& SampledPath::operator+=(const SampledPath& other) {
  assert(other.values_.size() == values_.size());
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += other.values_[i];
  return *this;
}

SampledPath SampledPath::integral() const {
  std::vector<Eigen::Vector3d> sums(values_.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 1; i < sums.size(); ++i)
    sums[i] = sums[i - 1] + (grid_.interval_s / 2) * (values_[i - 1] + values_[i]);
  return {grid_, std::move(sums)};
}

Eigen::Vector3d PathDraws::at(std::uint64_t step) const {
  return {field.normal(step, first_axis), field.normal(step, first_axis + 1),
          field.normal(step, first_axis + 2)};
}

SampledPath random_walk(const TimeGrid& grid, const Eigen::Vector3d& density, const PathDraws& draws) {
  const Eigen::Vector3d scale = std::sqrt(grid.interval_s) * density;
  std::vector<Eigen::Vector3d> values(grid.steps + 1, Eigen::Vector3d::Zero());
  for (std::size_t n = 1; n < values.size(); ++n) values[n] = values[n - 1] + scale.cwiseProduct(draws.at(n));
  return {grid, std::move(values)};
}

SampledPath gauss_markov(const TimeGrid& grid, const GaussMarkov& process, const PathDraws& draws) {
  const double kept = portable::exp(-grid.interval_s / process.time_s);
  // 1 - f^2, computed without cancellation for short intervals.
  const double renewed = std::sqrt(-portable::expm1(-2 * grid.interval_s / process.time_s));
  std::vector<Eigen::Vector3d> values(grid.steps + 1);
  values[0] = process.sigma.cwiseProduct(draws.at(0));
  for (std::size_t n = 1; n < values.size(); ++n)
    values[n] = kept * values[n - 1] + renewed * process.sigma.cwiseProduct(draws.at(n));
  return {grid, std::move(values)};
}

}  // namespace landfall
