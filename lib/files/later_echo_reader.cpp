// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/later_echo_reader.h"

#include <algorithm>
#include <span>
#include <string>

#include "returns/columns.h"
#include "simulation/echo_columns.h"

namespace landfall {
namespace {

std::int64_t pulse_of(const LaterEcho& echo) { return echo.where.pulse; }

}  // namespace

LaterEchoReader::LaterEchoReader(const LandfallFileReader& scan)
    : scan_(scan),
      table_(scan.root(), kEchoGroup, scan.name()),
      row_count_(table_.row_count(name_of(&EchoColumns::pulse))) {}

bool LaterEchoReader::is_next(const PulsePixel& where, std::size_t pixel_count) const {
  return where.pulse >= 0 && where.number >= 1 && where.pixel >= 0 &&
         where.pixel < static_cast<std::int64_t>(pixel_count) && (!last_ || *last_ < where);
}

void LaterEchoReader::read_rows(std::size_t pixel_count) {
  held_.erase(held_.begin(), held_.begin() + given_);
  given_ = 0;
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
    LaterEcho& echo = held_.emplace_back(where);
    for (const EchoMember& part : kEchoMembers) echo.echo.*part.member = (rows.*part.later)[i];
    last_ = where;
  }
}

std::vector<LaterEcho> LaterEchoReader::read(PulseSpan pulses, std::size_t pixel_count) {
  if (pulses.first < given_pulses_) {
    held_.clear();
    given_ = 0;
    last_.reset();
    next_row_ = 0;
  }
  given_pulses_ = pulses.first + pulses.count;
  while (next_row_ < row_count_ && (held_.empty() || pulse_of(held_.back()) < given_pulses_))
    read_rows(pixel_count);
  const auto end_before = [&](std::int64_t pulse) {
    return std::ranges::lower_bound(held_.begin() + given_, held_.end(), pulse, {}, pulse_of);
  };
  const auto first = end_before(pulses.first);
  const auto end = end_before(given_pulses_);
  given_ = end - held_.begin();
  return {first, end};
}

}  // namespace landfall
