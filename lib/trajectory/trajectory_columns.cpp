// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D80
#include "trajectory/trajectory_columns.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "base/joined.h"
#include "geometry/rotation.h"

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

}  // namespace landfall
