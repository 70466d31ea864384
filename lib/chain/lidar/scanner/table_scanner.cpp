// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/scanner/table_scanner.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/core/error.h"
#include "base/text/number_table.h"
#include "base/text/number_text.h"
#include "chain/lidar/scanner/gimbal.h"

namespace landfall {
namespace {

constexpr double kTableRounding_s = 1e-9;

void check_samples(const std::vector<AngleSample>& samples, const std::string& name) {
  require_timed_rows<AngleSample>(samples, name, [](const AngleSample& s) {
    return std::isfinite(s.angles.angle_1_rad) && std::isfinite(s.angles.angle_2_rad);
  });
}

}  // namespace

TableColumns angle_columns() { return {.required = {"t_s", "angle_1_rad", "angle_2_rad"}}; }

std::vector<AngleSample> angle_samples(const NumberTable& table) {
  const auto& t_s = table.column("t_s");
  const auto& angle_1 = table.column("angle_1_rad");
  const auto& angle_2 = table.column("angle_2_rad");
  std::vector<AngleSample> samples(table.row_count());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = {t_s[i], {angle_1[i], angle_2[i]}};
  return samples;
}

TableScanner::TableScanner(std::vector<AngleSample> samples, const std::optional<TableMirror>& mirror,
                           std::string name)
    : samples_(std::move(samples)), name_(std::move(name)) {
  if (mirror) mirror_.emplace(mirror->incidence_rad, mirror->fold_azimuth_rad);
  check_samples(samples_, name_);
}

void TableScanner::refuse(const PulseTime& pulse, const std::string& what) const {
  throw FormatError(name_ + ": pulse " + std::to_string(pulse.pulse) + ", " +
                    number_text(pulse.since_start_s) + " s after the first, " + what);
}

TiltAngles TableScanner::angles(const PulseTime& pulse) const {
  const double first_s = samples_.front().t_s;
  const double last_s = samples_.back().t_s;
  const double wanted_s = pulse.since_start_s;
  if (!(wanted_s >= first_s - kTableRounding_s && wanted_s <= last_s + kTableRounding_s))
    refuse(pulse, "is outside the table, which goes from " + number_text(first_s) + " to " +
                      number_text(last_s) + " s");
  const double t_s = std::clamp(wanted_s, first_s, last_s);
  // The first row after t, but neither the first row of the table nor the end.
  const auto after = std::upper_bound(samples_.begin() + 1, samples_.end() - 1, t_s,
                                      [](double t, const AngleSample& row) { return t < row.t_s; });
  const AngleSample& before = *(after - 1);
  return between(before.angles, (t_s - before.t_s) / (after->t_s - before.t_s), after->angles);
}

ScannerState TableScanner::state(const PulseContext& pulse) const {
  const TiltAngles tilts = angles(pulse.time);
  ScannerState state{.angle_1_rad = tilts.angle_1_rad, .angle_2_rad = tilts.angle_2_rad};
  if (!mirror_) return state;
  state.mirror_normal = mirror_->normal(tilts);
  if (!(mirror_->incoming().dot(state.mirror_normal.v) < 0))
    refuse(pulse.time, "turns the back of the mirror to the boresight");
  return state;
}

void TableScanner::steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                         std::span<Beam> beams) const {
  const Eigen::Matrix3d rotation = mirror_ ? mirror_->steering(state.mirror_normal)
                                           : gimbal_rotation({state.angle_1_rad, state.angle_2_rad});
  rotate_all(rotation, pixels, beams);
}

}  // namespace landfall
