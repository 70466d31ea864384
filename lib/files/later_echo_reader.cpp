// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/later_echo_reader.h"

#include <algorithm>
#include <array>
#include <string>

#include "returns/columns.h"

namespace landfall {
namespace {

std::int64_t pulse_of(const LaterEcho& echo) { return echo.where.pulse; }

bool is_before(const PulsePixel& a, const PulsePixel& b) {
  return std::tuple(a.pulse, a.pixel, a.number) < std::tuple(b.pulse, b.pixel, b.number);
}

}  // namespace

LaterEchoReader::LaterEchoReader(const LandfallFileReader& scan)
    : scan_(scan),
      table_(scan.root(), kEchoGroup, scan.name()),
      row_count_(table_.row_count(name_of(&EchoColumns::pulse))) {}

bool LaterEchoReader::is_next(const PulsePixel& where, std::size_t pixel_count) const {
  return where.pulse >= 0 && where.number >= 1 && where.pixel >= 0 &&
         where.pixel < static_cast<std::int64_t>(pixel_count) && (!last_ || is_before(*last_, where));
}

void LaterEchoReader::read_rows(std::size_t pixel_count) {
  EchoColumns rows;
  const std::size_t count = std::min(kTableChunkRows, row_count_ - next_row_);
  for_each_column(kEchoColumns, [&](const auto& column) {
    (rows.*column.rows).resize(count);
    table_.read(column.name, next_row_, std::span(rows.*column.rows));
  });
  for (std::size_t i = 0; i < count; ++i, ++next_row_) {
    const PulsePixel where{rows.pulse[i], rows.pixel[i], rows.number[i]};
    if (!is_next(where, pixel_count))
      scan_.fail("/" + std::string(kEchoGroup) + " row " + std::to_string(next_row_) +
                 " is not the next echo of a pixel");
    held_.push_back({where, {rows.signal[i], rows.peak[i], rows.edge[i], rows.width[i], rows.range[i]}});
    last_ = where;
  }
}

std::vector<LaterEcho> LaterEchoReader::read(PulseSpan pulses, std::size_t pixel_count) {
  if (pulses.first < given_pulses_) {
    held_.clear();
    last_.reset();
    next_row_ = 0;
  }
  given_pulses_ = pulses.first + pulses.count;
  while (next_row_ < row_count_ && (held_.empty() || pulse_of(held_.back()) < given_pulses_))
    read_rows(pixel_count);
  const auto first = std::ranges::lower_bound(held_, pulses.first, {}, pulse_of);
  const auto end = std::ranges::lower_bound(held_, given_pulses_, {}, pulse_of);
  std::vector<LaterEcho> found(first, end);
  held_.erase(held_.begin(), end);
  return found;
}

}  // namespace landfall
