// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D14, D37
#include "trajectory/table_trajectory.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/number_table.h"
#include "base/number_text.h"
#include "geometry/rotation_vector.h"
#include "trajectory/hermite.h"

namespace landfall {
namespace {

constexpr double kNormTolerance = 1e-3;
constexpr double kMaxSpeed_mps = 299'792'458;

void check(const std::vector<TrajectorySample>& samples, const std::string& name) {
  require_timed_rows<TrajectorySample>(samples, name, [](const TrajectorySample& s) {
    return s.position_m.v.allFinite() && s.attitude.coeffs().allFinite() &&
           (!s.velocity_mps || s.velocity_mps->v.allFinite());
  });
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double norm = samples[i].attitude.norm();
    if (std::abs(norm - 1) > kNormTolerance)
      refuse_row(name, i, "the quaternion's norm is " + number_text(norm) + ", not within 0.001 of 1");
  }
}

/// Mean velocity from sample i to the next.
Vector<DemFrame> secant(std::span<const TrajectorySample> samples, std::size_t i) {
  return (1 / (samples[i + 1].t_s - samples[i].t_s)) * (samples[i + 1].position_m - samples[i].position_m);
}

/// The velocities, at three samples, of the parabola through them.
struct ParabolaSlopes {
  Vector<DemFrame> first;
  Vector<DemFrame> middle;
  Vector<DemFrame> last;
};

ParabolaSlopes parabola_slopes(std::span<const TrajectorySample> three) {
  const double before = three[1].t_s - three[0].t_s;
  const double whole = three[2].t_s - three[0].t_s;
  const Vector<DemFrame> into = secant(three, 0);
  const Vector<DemFrame> out_of = secant(three, 1);
  const Vector<DemFrame> middle = into + (before / whole) * (out_of - into);
  return {2 * into - middle, middle, 2 * out_of - middle};
}

std::vector<Vector<DemFrame>> parabola_slopes_of_all(std::span<const TrajectorySample> samples) {
  const std::size_t count = samples.size();
  if (count == 2) return std::vector<Vector<DemFrame>>(2, secant(samples, 0));
  std::vector<Vector<DemFrame>> result(count);
  for (std::size_t i = 1; i + 1 < count; ++i) result[i] = parabola_slopes(samples.subspan(i - 1, 3)).middle;
  result.front() = parabola_slopes(samples.first(3)).first;
  result.back() = parabola_slopes(samples.last(3)).last;
  return result;
}

std::vector<Vector<DemFrame>> slopes(std::span<const TrajectorySample> samples) {
  std::vector<Vector<DemFrame>> result = parabola_slopes_of_all(samples);
  for (std::size_t i = 0; i < samples.size(); ++i) result[i] = samples[i].velocity_mps.value_or(result[i]);
  return result;
}

/// Steps of t_s that are too small, or positions that are too far apart, would make positions NaN.
void check_slopes(std::span<const Vector<DemFrame>> slopes_mps, const std::string& name) {
  for (std::size_t i = 0; i < slopes_mps.size(); ++i)
    if (!(slopes_mps[i].v.norm() <= kMaxSpeed_mps))
      refuse_row(name, i,
                 "the rows about it, or its velocity, give more than the speed of light; a step of t_s is "
                 "too small, or a length is not in metres");
}

}  // namespace

TableTrajectory::TableTrajectory(std::vector<TrajectorySample> samples, std::string name)
    : name_(std::move(name)),
      epoch_s_(samples.empty() ? 0 : samples.front().t_s),
      samples_(std::move(samples)) {
  for (TrajectorySample& sample : samples_) sample.t_s -= epoch_s_;
  check(samples_, name_);
  for (TrajectorySample& sample : samples_) sample.attitude.normalize();
  slopes_mps_ = slopes(samples_);
  check_slopes(slopes_mps_, name_);
}

Pose TableTrajectory::pose(double t_s) const {
  if (!(t_s >= -kTimeSlack_s && t_s <= end_time_s() + kTimeSlack_s))
    throw FormatError(name_ + ": time " + number_text(t_s) + " s lies outside the table, 0 .. " +
                      number_text(end_time_s()) + " s" +
                      (epoch_s_ == 0 ? "" : " after its first row, t_s = " + number_text(epoch_s_)));
  const double t = std::clamp(t_s, 0.0, end_time_s());
  // The piece that begins at or before t. The last time belongs to the last piece.
  const auto next = std::upper_bound(samples_.begin() + 1, samples_.end() - 1, t,
                                     [](double time, const TrajectorySample& s) { return time < s.t_s; });
  const auto i = static_cast<std::size_t>(next - samples_.begin()) - 1;
  const double h = samples_[i + 1].t_s - samples_[i].t_s;
  const double u = (t - samples_[i].t_s) / h;
  const Eigen::Vector3d position = hermite(u, {samples_[i].position_m.v, h * slopes_mps_[i].v},
                                           {samples_[i + 1].position_m.v, h * slopes_mps_[i + 1].v});
  const Eigen::Quaterniond& before = samples_[i].attitude;
  const Eigen::Vector3d turn = rotation_vector(before.conjugate() * samples_[i + 1].attitude);
  const Eigen::Quaterniond attitude = (before * quaternion_of(u * turn)).normalized();
  return {{attitude.toRotationMatrix()}, {position}};
}

}  // namespace landfall
