// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D14, D37, D80
#include "chain/lidar/trajectory/table_trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "base/core/error.h"
#include "base/geometry/rotation.h"
#include "base/geometry/rotation_vector.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "chain/lidar/trajectory/hermite.h"

namespace landfall {
namespace {

using Names = std::vector<std::string>;

const Names kQuaternion = {"qw", "qx", "qy", "qz"};
const Names kRollPitchYaw = {"roll_deg", "pitch_deg", "yaw_deg"};
const Names kRodrigues = {"mrp_1", "mrp_2", "mrp_3"};
const Names kVelocity = {"vx_mps", "vy_mps", "vz_mps"};

std::string list_of(const Names& names) { return joined(names, ","); }

/// Whether the table has all of these columns. Refuses a table that has only some of them.
bool has_all(const NumberTable& table, const Names& names) {
  const auto is_there = [&](const std::string& name) { return table.has(name); };
  if (std::ranges::none_of(names, is_there)) return false;
  for (const std::string& name : names)
    if (!table.has(name)) table.fail("no column " + name + ", but has others of " + list_of(names));
  return true;
}

Eigen::Vector3d vector_of(const NumberTable& table, const Names& names, std::size_t row) {
  return {table.column(names[0])[row], table.column(names[1])[row], table.column(names[2])[row]};
}

using AttitudeReader = Eigen::Quaterniond (*)(const NumberTable& table, std::size_t row);

Eigen::Quaterniond from_quaternion(const NumberTable& table, std::size_t row) {
  const auto value = [&](std::size_t i) { return table.column(kQuaternion[i])[row]; };
  return {value(0), value(1), value(2), value(3)};
}

Eigen::Quaterniond from_roll_pitch_yaw(const NumberTable& table, std::size_t row) {
  const Eigen::Vector3d angles = std::numbers::pi / 180 * vector_of(table, kRollPitchYaw, row);
  return Eigen::Quaterniond(rotation_matrix({angles.x(), angles.y(), angles.z()}));
}

/// With s = |sigma|^2: q = (1 - s, 2 sigma) / (1 + s). The shadow set gives -q. [BN] maps components in N to
/// components in B, so its transpose, R_dem_body, is the active rotation that q represents.
Eigen::Quaterniond from_rodrigues(const NumberTable& table, std::size_t row) {
  const Eigen::Vector3d sigma = vector_of(table, kRodrigues, row);
  const double s = sigma.squaredNorm();
  Eigen::Quaterniond q;
  q.w() = (1 - s) / (1 + s);
  q.vec() = 2 / (1 + s) * sigma;
  return q;
}

struct AttitudeColumns {
  const Names& names;
  AttitudeReader read;
};

const std::array<AttitudeColumns, 3>& attitude_columns() {
  static const std::array<AttitudeColumns, 3> all = {
      {{kQuaternion, from_quaternion}, {kRollPitchYaw, from_roll_pitch_yaw}, {kRodrigues, from_rodrigues}}};
  return all;
}

AttitudeReader attitude_reader(const NumberTable& table) {
  AttitudeReader found = nullptr;
  for (const AttitudeColumns& columns : attitude_columns()) {
    if (!has_all(table, columns.names)) continue;
    if (found != nullptr)
      table.fail("has two attitudes: keep one of " + list_of(kQuaternion) + ", " + list_of(kRollPitchYaw) +
                 " and " + list_of(kRodrigues));
    found = columns.read;
  }
  if (found == nullptr)
    table.fail("has no attitude: add the columns " + list_of(kQuaternion) + ", or " + list_of(kRollPitchYaw) +
               ", or " + list_of(kRodrigues));
  return found;
}

TableColumns all_columns() {
  TableColumns columns{.required = {"t_s", "x_m", "y_m", "z_m"}};
  for (const Names& names : {kQuaternion, kRollPitchYaw, kRodrigues, kVelocity})
    columns.optional.insert(columns.optional.end(), names.begin(), names.end());
  return columns;
}

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

const TableColumns& trajectory_columns() {
  static const TableColumns columns = all_columns();
  return columns;
}

std::vector<TrajectorySample> trajectory_samples(const NumberTable& table) {
  const AttitudeReader attitude = attitude_reader(table);
  const bool has_velocity = has_all(table, kVelocity);
  const Names position = {"x_m", "y_m", "z_m"};
  std::vector<TrajectorySample> samples(table.row_count());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = {table.column("t_s")[i], {vector_of(table, position, i)}, attitude(table, i)};
    if (has_velocity) samples[i].velocity_mps = Vector<DemFrame>{vector_of(table, kVelocity, i)};
  }
  return samples;
}

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
