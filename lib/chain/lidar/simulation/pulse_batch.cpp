// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/pulse_batch.h"

#include <algorithm>
#include <type_traits>
#include <vector>

namespace landfall {
namespace {

template <class T>
bool is_place(std::vector<T> PointColumns::*rows) {
  if constexpr (std::is_same_v<T, double>) return std::ranges::find(kCoordinates, rows) != kCoordinates.end();
  return std::is_same_v<T, PointStatus>;
}

}  // namespace

void PulseBatch::resize(std::size_t pulse_count, std::size_t rows_per_pulse, PointContent content,
                        const OptionalColumns& optional) {
  for_each_column(kPointColumns, [&](const auto& column) {
    const bool wanted = content == PointContent::all ||
                        (content == PointContent::estimate && column.effect == ErrorEffect::changed) ||
                        (content == PointContent::places && is_place(column.rows));
    (points.*column.rows).resize(wanted && optional.has(column.group) ? pulse_count * rows_per_pulse : 0);
  });
  for_each_column(kPulseColumns, [&](const auto& column) { (pulses.*column.rows).resize(pulse_count); });
  for_each_column(kEchoColumns, [&](const auto& column) { (later_echoes.*column.rows).clear(); });
  keeps_later_echoes = optional.later_echoes;
}

std::array<std::int64_t, kPointStatusCount> PulseBatch::status_counts() const {
  std::array<std::int64_t, kPointStatusCount> counts{};
  for (const PointStatus status : points.status) ++counts[static_cast<std::size_t>(status)];
  return counts;
}

void PulseBatch::keep_rows(const auto& is_kept) {
  std::vector<std::size_t> kept;
  kept.reserve(points.size());
  std::size_t row = 0;
  for (std::int32_t& count : pulses.point_count) {
    const std::size_t before = kept.size();
    for (const std::size_t end = row + static_cast<std::size_t>(count); row < end; ++row)
      if (is_kept(row)) kept.push_back(row);
    count = static_cast<std::int32_t>(kept.size() - before);
  }
  for_each_column(kPointColumns, [&](const auto& column) {
    auto& rows = points.*column.rows;
    if (rows.empty()) return;
    for (std::size_t i = 0; i < kept.size(); ++i) rows[i] = rows[kept[i]];
    rows.resize(kept.size());
  });
}

void PulseBatch::keep_returns() {
  if (std::all_of(points.status.begin(), points.status.end(), is_return)) return;
  keep_rows([&](std::size_t row) { return is_return(points.status[row]); });
}

void PulseBatch::remove_absent_returns() {
  keep_rows([&](std::size_t row) { return points.return_number[row] != kNoSuchReturn; });
}

}  // namespace landfall
