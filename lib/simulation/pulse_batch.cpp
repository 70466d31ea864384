// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/pulse_batch.h"

#include <algorithm>

namespace landfall {

void PulseBatch::resize(std::size_t pulse_count, std::size_t pixel_count, PointContent content) {
  const std::size_t rows = pulse_count * pixel_count;
  PointColumns& p = points;
  for (auto* const column : {&p.x_est, &p.y_est, &p.z_est, &p.range_measured}) column->resize(rows);
  p.status.resize(rows);
  const std::size_t truth_rows = content == PointContent::all ? rows : 0;
  for (auto* const column : {&p.x_true, &p.y_true, &p.z_true, &p.range_true}) column->resize(truth_rows);
  p.pulse.resize(truth_rows);
  p.pixel.resize(truth_rows);
  PulseColumns::for_each(pulses, [&](const char*, auto& column) { column.resize(pulse_count); });
}

std::array<std::int64_t, kPointStatusCount> PulseBatch::status_counts() const {
  std::array<std::int64_t, kPointStatusCount> counts{};
  for (const PointStatus status : points.status) ++counts[static_cast<std::size_t>(status)];
  return counts;
}

void PulseBatch::keep_returns() {
  if (std::all_of(points.status.begin(), points.status.end(), is_return)) return;
  std::vector<std::size_t> kept;
  kept.reserve(points.size());
  std::size_t row = 0;
  for (std::int32_t& count : pulses.point_count) {
    const std::size_t before = kept.size();
    for (const std::size_t end = row + static_cast<std::size_t>(count); row < end; ++row)
      if (is_return(points.status[row])) kept.push_back(row);
    count = static_cast<std::int32_t>(kept.size() - before);
  }
  PointColumns::for_each(points, [&](const char*, auto& column) {
    if (column.empty()) return;
    for (std::size_t i = 0; i < kept.size(); ++i) column[i] = column[kept[i]];
    column.resize(kept.size());
  });
}

}  // namespace landfall
